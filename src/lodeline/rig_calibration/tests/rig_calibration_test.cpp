#include "lodeline/rig_calibration/result/rig_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/report/rig_report.h"
#include "lodeline/rig_calibration/tests/test_board_record.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using test::BoardTrial;
using ::testing::HasSubstr;

std::vector<double> lensOf(const CameraCalibration& c) {
  std::vector<double> lens = {c.fx_px, c.fy_px, c.cx_px, c.cy_px};
  lens.insert(lens.end(), c.distortion.begin(), c.distortion.end());
  return lens;
}

/// Errors in sigmas of everything that was calibrated.
class Errors {
 public:
  void add(double error, double sigma) { sigmas_.push_back(error / sigma); }
  void add(const Vec3& error, const Vec3& sigma) {
    for (int i = 0; i < 3; ++i) add(error[i], sigma[i]);
  }
  void addPose(const Rigid3& pose, const Rigid3& truth, const PoseSigmas& sigmas) {
    add(so3::log(pose.rotation * truth.rotation.conjugate()), sigmas.rotation_rad);
    add(pose.translation - truth.translation, sigmas.translation_m);
  }
  double largest() const {
    double largest = 0.0;
    for (const double s : sigmas_) largest = std::max(largest, std::abs(s));
    return largest;
  }
  double rms() const {
    double sum = 0.0;
    for (const double s : sigmas_) sum += s * s;
    return std::sqrt(sum / static_cast<double>(sigmas_.size()));
  }

 private:
  std::vector<double> sigmas_;
};

void addCamera(const RigCalibrationResult& result, const Rig& truth, size_t k, Errors* errors) {
  const CameraCalibrationResult& camera = result.cameras[k];
  const CameraCalibration& true_camera = truth.cameras[k];
  const std::vector<double> lens = lensOf(camera.calibration), true_lens = lensOf(true_camera);
  for (size_t i = 0; i < camera.lens_sigmas.size(); ++i)
    errors->add(lens[i] - true_lens[i], camera.lens_sigmas[i]);
  if (camera.body_sigmas)
    errors->addPose(camera.calibration.body_from_camera, true_camera.body_from_camera, *camera.body_sigmas);
  if (camera.first_sigmas) {
    errors->addPose(camera.first_from_camera,
                    truth.cameras[0].body_from_camera.inverse() * true_camera.body_from_camera,
                    *camera.first_sigmas);
  }
  if (camera.delay_sigma_s)
    errors->add(camera.calibration.time_offset_to_imu_s - true_camera.time_offset_to_imu_s,
                *camera.delay_sigma_s);
}

RigCalibrationResult calibrated(const BoardRecord& record, const RigCalibrationOptions& options = {}) {
  Diagnostics diagnostics;
  return calibrateRig(record, options, &diagnostics);
}

/// The record without what its files state of the cameras.
BoardRecord withoutStated(BoardRecord record) {
  for (size_t k = 0; k < record.rig.cameras.size(); ++k) {
    CameraCalibration bare;
    bare.name = record.rig.cameras[k].name;
    bare.width_px = record.rig.cameras[k].width_px;
    bare.height_px = record.rig.cameras[k].height_px;
    record.rig.cameras[k] = bare;
    record.has_lens[k] = false;
  }
  return record;
}

bool hasDoubt(const RigCalibrationResult& result, const std::string& text) {
  return std::any_of(result.doubts.begin(), result.doubts.end(), [&](const CalibrationDoubt& doubt) {
    return doubt.text.find(text) != std::string::npos;
  });
}

TEST(RigCalibration, FindsEverythingWithoutAStatedCalibration) {
  const BoardTrial trial;
  const Rig truth = test::trueRig(trial);
  const RigCalibrationResult result = calibrated(withoutStated(test::boardRecord(trial)));
  EXPECT_EQ(result.verdict, CalibrationVerdict::Good) << rigCalibrationText(result);
  Errors errors;
  for (size_t k = 0; k < 2; ++k) {
    const CameraCalibration &c = result.cameras[k].calibration, &t = truth.cameras[k];
    EXPECT_NEAR(c.fx_px / t.fx_px, 1.0, 5e-4);
    EXPECT_NEAR(c.cx_px, t.cx_px, 0.3);
    EXPECT_NEAR(c.cy_px, t.cy_px, 0.3);
    EXPECT_LT(so3::log(c.body_from_camera.rotation * t.body_from_camera.rotation.conjugate()).norm(),
              0.05 * kDegree);
    EXPECT_LT((c.body_from_camera.translation - t.body_from_camera.translation).norm(), 1e-3);
    EXPECT_NEAR(c.time_offset_to_imu_s, trial.delay_s, 1e-4);
    EXPECT_NEAR(result.cameras[k].sigma_px, trial.pixel_sigma_px, 0.01);
    addCamera(result, truth, k, &errors);
  }
  EXPECT_LT(errors.largest(), 4.0);
  EXPECT_LT(errors.rms(), 1.4);
  EXPECT_GT(errors.rms(), 0.5);
}

TEST(RigCalibration, FindsAFlatPortWithTheLensFromAir) {
  BoardTrial trial;
  trial.seed = 2;
  trial.port = Port();
  trial.port->normal_C = Vec3(0.01, -0.015, 1.0).normalized();
  trial.port->distance_m = 0.021;
  trial.port->thickness_m = 0.008;
  trial.port->index_water = 1.337;
  BoardRecord record = test::boardRecord(trial);
  for (CameraCalibration& camera : record.rig.cameras) {
    camera.port->normal_C = Vec3::UnitZ();
    camera.port->distance_m = 0.015;
    camera.port->index_water = 1.333;
  }
  for (const bool keeps_lens : {true, false}) {
    RigCalibrationOptions options;
    options.keeps_lens = keeps_lens;
    // Beside an unknown lens, the index must be the right one.
    if (!keeps_lens)
      for (CameraCalibration& camera : record.rig.cameras) camera.port->index_water = 1.337;
    const RigCalibrationResult result = calibrated(record, options);
    EXPECT_NE(result.verdict, CalibrationVerdict::Poor) << rigCalibrationText(result);
    for (const CameraCalibrationResult& camera : result.cameras) {
      const Port& port = *camera.calibration.port;
      EXPECT_LT(std::acos(std::min(1.0, port.normal_C.dot(trial.port->normal_C))), 0.05 * kDegree);
      ASSERT_TRUE(camera.port_sigmas);
      EXPECT_LT(std::abs(port.distance_m - trial.port->distance_m), 4.0 * camera.port_sigmas->z());
      EXPECT_LT(camera.port_sigmas->z(), 5e-4);
      EXPECT_EQ(camera.lens_sigmas.empty(), keeps_lens);
      EXPECT_EQ(camera.index_sigma.has_value(), keeps_lens);
      if (camera.index_sigma) {
        EXPECT_LT(std::abs(port.index_water - 1.337), 4.0 * *camera.index_sigma);
        EXPECT_LT(*camera.index_sigma, 5e-4);
      }
    }
  }
}

TEST(RigCalibration, FindsTheCentreOfADome) {
  BoardTrial trial;
  trial.seed = 3;
  trial.port = Port();
  trial.port->type = Port::Type::Dome;
  trial.port->centre_C = Vec3(0.001, -0.002, 0.005);
  trial.port->radius_m = 0.05;
  trial.port->thickness_m = 0.006;
  BoardRecord record = test::boardRecord(trial);
  for (CameraCalibration& camera : record.rig.cameras) camera.port->centre_C = Vec3::Zero();
  RigCalibrationOptions options;
  options.keeps_lens = true;
  options.uses_imu = false;
  const RigCalibrationResult result = calibrated(record, options);
  EXPECT_FALSE(result.inertial);
  EXPECT_FALSE(result.without_inertial.empty());
  for (const CameraCalibrationResult& camera : result.cameras) {
    Errors errors;
    errors.add(Vec3(camera.calibration.port->centre_C - trial.port->centre_C), *camera.port_sigmas);
    EXPECT_LT(errors.largest(), 4.0) << rigCalibrationText(result);
    EXPECT_LT((camera.calibration.port->centre_C - trial.port->centre_C).norm(), 5e-4);
  }
}

TEST(RigCalibration, CalibratesAFisheyeWithItsModel) {
  BoardTrial trial;
  trial.camera_model = "equidistant";
  trial.duration_s = 12.0;
  RigCalibrationOptions options;
  options.model = "equidistant";
  options.uses_imu = false;
  const Rig truth = test::trueRig(trial);
  const RigCalibrationResult result = calibrated(withoutStated(test::boardRecord(trial)), options);
  Errors errors;
  for (size_t k = 0; k < 2; ++k) addCamera(result, truth, k, &errors);
  EXPECT_LT(errors.largest(), 4.0) << rigCalibrationText(result);
}

TEST(RigCalibration, LeavesOutTagsInTheWrongPlace) {
  BoardTrial trial;
  trial.duration_s = 12.0;
  BoardRecord record = test::boardRecord(trial);
  for (size_t f = 0; f < record.frames.size(); f += 4) {
    for (BoardView& view : record.frames[f].views) {
      for (size_t i = 0; i < 4; ++i) view.corners[i].pixel += Vec2(9.0, -6.0);
    }
  }
  RigCalibrationOptions options;
  options.uses_imu = false;
  const Rig truth = test::trueRig(trial);
  const RigCalibrationResult result = calibrated(record, options);
  EXPECT_NEAR(result.cameras[0].calibration.fx_px / truth.cameras[0].fx_px, 1.0, 5e-4);
  EXPECT_GT(result.cameras[0].outlier_share, 0.005);
}

TEST(RigCalibration, SaysWhatALensOfTheWrongModelLeaves) {
  BoardTrial trial;
  trial.duration_s = 12.0;
  RigCalibrationOptions options;
  options.model = "none";
  options.uses_imu = false;
  const RigCalibrationResult result = calibrated(test::boardRecord(trial), options);
  EXPECT_NE(result.verdict, CalibrationVerdict::Good);
  EXPECT_TRUE(hasDoubt(result, "residual is large")) << rigCalibrationText(result);
}

TEST(RigCalibration, IsPoorWithoutMotion) {
  BoardTrial trial;
  trial.duration_s = 8.0;
  trial.frozen_at_s = 4.0;
  const RigCalibrationResult result = calibrated(test::boardRecord(trial));
  EXPECT_EQ(result.verdict, CalibrationVerdict::Poor);
  EXPECT_TRUE(hasDoubt(result, "little rotation")) << rigCalibrationText(result);
  EXPECT_TRUE(hasDoubt(result, "delay to the IMU is hardly observable")) << rigCalibrationText(result);
  EXPECT_TRUE(hasDoubt(result, "poor coverage")) << rigCalibrationText(result);
}

TEST(RigCalibration, IsPoorWithFewViews) {
  BoardTrial trial;
  BoardRecord record = test::boardRecord(trial);
  record.frames.resize(5);
  RigCalibrationOptions options;
  options.uses_imu = false;
  const RigCalibrationResult result = calibrated(record, options);
  EXPECT_EQ(result.verdict, CalibrationVerdict::Poor);
  EXPECT_TRUE(hasDoubt(result, "too few views"));
}

TEST(RigCalibration, RefusesCamerasThatNeverSeeTheBoardTogether) {
  BoardTrial trial;
  BoardRecord record = test::boardRecord(trial);
  for (size_t f = 0; f < record.frames.size(); ++f)
    std::erase_if(record.frames[f].views, [&](const BoardView& view) { return view.camera != f % 2; });
  std::erase_if(record.frames, [](const BoardFrame& frame) { return frame.views.empty(); });
  try {
    calibrated(record);
    FAIL() << "accepted";
  } catch (const EstimationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("never sees the board at the same time"));
  }
  for (BoardFrame& frame : record.frames)
    std::erase_if(frame.views, [](const BoardView& view) { return view.camera == 1; });
  try {
    calibrated(record);
    FAIL() << "accepted";
  } catch (const EstimationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cam1: no board found"));
  }
}

}  // namespace
}  // namespace lodeline

// Real images (EuRoC MH_01_easy, first 14 s) resampled for other camera models: the trajectory must be
// equally accurate with every model.

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

struct Lens {
  const char* model;
  /// Long enough for the whole view to be within the original images, which extend to 37 degrees off the
  /// axis.
  double focal_length_px;
  std::vector<double> distortion;
};

/// Resamples a camera's images to another camera model.
class IntrinsicsChange {
 public:
  /// Changes `calibration` to that of the new model.
  IntrinsicsChange(const Lens& lens, CameraCalibration* calibration) {
    const auto from = makeCamera(*calibration);
    calibration->model = lens.model;
    calibration->distortion = lens.distortion;
    calibration->fx_px = lens.focal_length_px;
    calibration->fy_px = 1.01 * lens.focal_length_px;
    calibration->cx_px += 5.0;
    const auto to = makeCamera(*calibration);
    sources_.create(calibration->height_px, calibration->width_px);
    for (int y = 0; y < sources_.rows; ++y) {
      for (int x = 0; x < sources_.cols; ++x) {
        const std::optional<Vec3> ray = to->unproject(Vec2(x, y));
        const std::optional<Vec2> source = ray ? from->project(*ray) : std::nullopt;
        sources_(y, x) = source ? cv::Vec2f(source->cast<float>().x(), source->cast<float>().y())
                                : cv::Vec2f(-1.0f, -1.0f);
        seen_ += source && from->contains(*source) ? 1 : 0;
      }
    }
  }

  /// Share of the new image that the old one covers.
  double shareSeen() const { return seen_ / static_cast<double>(sources_.total()); }

  void apply(cv::Mat* image) const {
    cv::Mat taken;
    cv::remap(*image, taken, sources_, cv::noArray(), cv::INTER_CUBIC);
    *image = taken;
  }

 private:
  cv::Mat_<cv::Vec2f> sources_;
  int seen_ = 0;
};

class LensModels : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const auto recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    recording_ = *recording;
  }

  Trajectory estimate(const Lens& lens) const {
    Diagnostics diagnostics;
    EurocOptions options;
    if (GetParam() == 1) options.camera_indices = {0};
    EurocSource source(recording_, options, &diagnostics);
    Rig rig = source.rig();
    std::vector<IntrinsicsChange> changes;
    for (CameraCalibration& camera : rig.cameras) {
      changes.emplace_back(lens, &camera);
      EXPECT_GT(changes.back().shareSeen(), 0.97) << "the images do not show all that such a lens sees";
    }
    Synchronizer synchronizer(&source, {}, &diagnostics);
    PacketOdometry odometry(rig, {}, &diagnostics);
    Trajectory trajectory;
    while (auto packet = synchronizer.next()) {
      for (size_t camera = 0; camera < changes.size(); ++camera) {
        if (!packet->images[camera].empty()) changes[camera].apply(&packet->images[camera]);
      }
      const FrameEstimate estimate = odometry.add(*packet);
      if (estimate.status != Status::Waiting)
        trajectory.poses.push_back({estimate.time, estimate.state.world_from_body});
    }
    return trajectory;
  }

  /// Expects the same accuracy as for the original images (run_real_test.cpp).
  void expectItsFigures(const Lens& lens) const {
    Diagnostics ignored;
    const Trajectory truth =
        readTrajectory(recording_ / "mav0/state_groundtruth_estimate0/gt_tum.txt", {}, ignored);
    EvaluationOptions options;
    options.alignment = GetParam() == 1 ? AlignmentType::Sim3 : AlignmentType::SE3;
    const Evaluation found = evaluate(estimate(lens), truth, options, ignored);
    EXPECT_GE(found.estimate.size(), 245u) << "of 288 images";
    EXPECT_LT(found.absolute.position().rmse, 0.015);
    EXPECT_LT(found.absolute.rotation().rmse, 1.0);
    EXPECT_LT(std::abs(found.alignment.scale - 1.0), 0.04);
    RecordProperty("position_um", static_cast<int>(1e6 * found.absolute.position().rmse));
    RecordProperty("rotation_mdeg", static_cast<int>(1e3 * found.absolute.rotation().rmse));
  }

  std::filesystem::path recording_;
};

TEST_P(LensModels, EquidistantReachesItsFigures) {
  expectItsFigures({"equidistant", 560.0, {-0.012, 0.004, -0.003, 0.0005}});
}

TEST_P(LensModels, DoubleSphereReachesItsFigures) {
  expectItsFigures({"double-sphere", 448.0, {-0.2, 0.57}});
}

TEST_P(LensModels, PinholeReachesItsFigures) { expectItsFigures({"none", 490.0, {}}); }

INSTANTIATE_TEST_SUITE_P(Cameras, LensModels, testing::Values(1, 2));

}  // namespace
}  // namespace lodeline

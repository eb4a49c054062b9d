#include "lodeline/io/calibration/kalibr_calibration.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// cam0 is rotated by 90 degrees about z relative to the IMU; cam1 is 0.1 m to its right.
constexpr const char* kCamchain = R"(cam0:
  T_cam_imu:
  - [0.0, 1.0, 0.0, 0.5]
  - [-1.0, 0.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.1, 0.2, 0.3, 0.4]
  distortion_model: equidistant
  intrinsics: [30.0, 31.0, 7.5, 5.5]
  resolution: [16, 12]
  rostopic: /cam0/image_raw
  timeshift_cam_imu: 0.0125
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [30.0, 31.0, 7.5, 5.5]
  resolution: [16, 12]
)";

constexpr const char* kImuOfKalibr = R"(imu0:
  T_i_b: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
  accelerometer_noise_density: 0.004
  accelerometer_random_walk: 0.005
  gyroscope_noise_density: 0.006
  gyroscope_random_walk: 0.007
  model: calibrated
  rostopic: /imu0
  time_offset: 0.0
  update_rate: 201.0
)";

class KalibrTest : public testing::Test {
 protected:
  Rig read() { return readEurocRig(findEurocLayout(recording_.folder(), {}), &diagnostics_); }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(KalibrTest, WinsOverSensorYamlAndSaysSo) {
  recording_.write("../camchain-imucam.yaml", kCamchain);
  recording_.write("imu.yaml", kImuOfKalibr);
  const Rig rig = read();
  ASSERT_EQ(rig.cameras.size(), 2u);
  const CameraCalibration& camera = rig.cameras[0];
  EXPECT_EQ(camera.fx_px, 30.0);
  EXPECT_EQ(camera.model, "equidistant");
  EXPECT_EQ(camera.time_offset_to_imu_s, 0.0125);
  EXPECT_EQ(camera.rate_hz, 20.0);
  EXPECT_TRUE((camera.body_from_camera.inverse() * Vec3(1, 0, 0)).isApprox(Vec3(0.5, -1, 0), 1e-12));
  EXPECT_EQ(rig.cameras[1].model, "none");
  EXPECT_TRUE((rig.cameras[1].body_from_camera.inverse() * Vec3(1, 0, 0)).isApprox(Vec3(0.4, -1, 0), 1e-12));
  EXPECT_EQ(rig.imu.rate_hz, 201.0);
  EXPECT_EQ(rig.imu.noise.accelerometer_density_m_per_s2_sqrtHz, 0.004);
  EXPECT_EQ(rig.imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz, 0.007);
  EXPECT_EQ(diagnostics_.count("kalibr_used"), 2);
  EXPECT_EQ(diagnostics_.ranked().size(), 1u);
}

TEST_F(KalibrTest, NeedsNoSensorYamlOfCamerasAndImu) {
  for (const char* file : {"cam0/sensor.yaml", "cam1/sensor.yaml", "imu0/sensor.yaml"}) {
    std::filesystem::remove(recording_.path(file));
  }
  recording_.write("dive3-camchain-imucam.yaml", kCamchain);
  recording_.write("../imu-dive3.yaml", std::string(kImuOfKalibr).substr(6));
  const Rig rig = read();
  EXPECT_NEAR(rig.cameras[1].rate_hz, 20.0, 1e-6);
  EXPECT_EQ(rig.imu.rate_hz, 201.0);
  EXPECT_EQ(diagnostics_.count("kalibr_used"), 0);
}

/// One section of a camchain, as Kalibr writes it for a model.
struct KalibrModel {
  const char* camera_model;
  const char* intrinsics;
  const char* distortion_model;
  const char* coefficients;
  const char* name;
  std::vector<double> parameters;
};

class KalibrModels : public KalibrTest, public testing::WithParamInterface<KalibrModel> {
 protected:
  static std::string chain(const KalibrModel& model) {
    return fmt::format(
        "cam0:\n  T_cam_imu: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n  camera_model: {}\n  intrinsics: {}\n"
        "  distortion_model: {}\n  distortion_coeffs: {}\n  resolution: [752, 480]\n  rostopic: /cam0\n{}",
        model.camera_model, model.intrinsics, model.distortion_model, model.coefficients, kImuOfKalibr);
  }
  RigFile readChain(const std::string& text) {
    recording_.write("chain.yaml", text);
    return readRigFiles({recording_.path("chain.yaml")}, &diagnostics_);
  }
};

TEST_P(KalibrModels, AreReadAndWritten) {
  const RigFile file = readChain(chain(GetParam()));
  for (const RigFile& rig : {file, readChain(rigText(file))}) {
    const CameraCalibration& camera = rig.rig.cameras.at(0);
    EXPECT_EQ(camera.model, GetParam().name);
    EXPECT_EQ(camera.fx_px, 301.0);
    EXPECT_EQ(camera.fy_px, 302.0);
    EXPECT_EQ(camera.cx_px, 370.0);
    EXPECT_EQ(camera.cy_px, 240.0);
    EXPECT_EQ(camera.distortion, GetParam().parameters);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Models, KalibrModels,
    testing::Values(
        KalibrModel{"pinhole", "[301, 302, 370, 240]", "none", "[]", "none", {}},
        KalibrModel{"pinhole",
                    "[301, 302, 370, 240]",
                    "radtan",
                    "[-0.1, 0.02, 1e-3, 2e-3]",
                    "radial-tangential",
                    {-0.1, 0.02, 1e-3, 2e-3}},
        KalibrModel{"pinhole",
                    "[301, 302, 370, 240]",
                    "equidistant",
                    "[-0.01, 0.02, -0.003, 0.004]",
                    "equidistant",
                    {-0.01, 0.02, -0.003, 0.004}},
        KalibrModel{"pinhole", "[301, 302, 370, 240]", "fov", "[0.93]", "field-of-view", {0.93}},
        KalibrModel{"ds", "[-0.2, 0.6, 301, 302, 370, 240]", "none", "[]", "double-sphere", {-0.2, 0.6}},
        KalibrModel{"eucm", "[0.6, 1.1, 301, 302, 370, 240]", "none", "[]", "extended-unified", {0.6, 1.1}},
        KalibrModel{"omni",
                    "[0.9, 301, 302, 370, 240]",
                    "radtan",
                    "[-0.1, 0.02, 1e-3, 2e-3]",
                    "unified",
                    {0.9, -0.1, 0.02, 1e-3, 2e-3}},
        KalibrModel{"omni", "[0.9, 301, 302, 370, 240]", "none", "[]", "unified", {0.9}}));

TEST_F(KalibrModels, AreRefusedWithTheKeyThatIsWrong) {
  const KalibrModel good{"ds", "[-0.2, 0.6, 301, 302, 370, 240]", "none", "[]", "", {}};
  KalibrModel swapped = good, odd = good, short_list = good, wide = good;
  swapped.intrinsics = "[301, 302, 370, 240, -0.2, 0.6]";
  odd.camera_model = "cubic";
  short_list.intrinsics = "[301, 302, 370, 240]";
  wide.intrinsics = "[-0.2, 0.6, 3.01, 3.02, 3.7, 2.4]";
  for (const auto& [model, complaint] :
       {std::pair(swapped, "xi of the double-sphere model is 301"), std::pair(odd, "camera_model 'cubic'"),
        std::pair(short_list, "must be 6 finite numbers (xi, alpha, fx, fy, cx, cy in px)"),
        std::pair(wide, "shares of the image's size")}) {
    const std::string text = chain(model);
    EXPECT_THAT([&] { readChain(text); }, ThrowsMessage<InputError>(HasSubstr(complaint)));
  }
  KalibrModel impossible = good;
  impossible.intrinsics = "[-0.2, 1.6, 301, 302, 370, 240]";
  EXPECT_THAT([&] { readChain(chain(impossible)); },
              ThrowsMessage<InputError>(testing::AllOf(
                  HasSubstr("cam0.intrinsics"), HasSubstr("alpha of the double-sphere model is 1.6"))));
}

TEST_F(KalibrTest, RefusesAChainWithoutImu) {
  std::string camchain = kCamchain;
  camchain.replace(camchain.find("T_cam_imu"), 9, "T_cam_xyz");
  recording_.write("camchain-imucam.yaml", camchain);
  EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(HasSubstr("key 'cam0.T_cam_imu' is missing")));
}

TEST_F(KalibrTest, RefusesAChainThatLacksACamera) {
  recording_.write("camchain-imucam.yaml",
                   std::string(kCamchain).substr(0, std::string(kCamchain).find("cam1:")));
  EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(HasSubstr("key 'cam1' is missing")));
}

TEST_F(KalibrTest, RefusesTwoFilesOfAKind) {
  recording_.write("camchain-imucam-a.yaml", kCamchain);
  recording_.write("camchain-imucam-b.yaml", kCamchain);
  EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(HasSubstr("keep the one that is valid")));
}

TEST_F(KalibrTest, RefusesWhatIsNoCamchain) {
  recording_.write("camchain-imucam.yaml", "- 1\n- 2\n");
  EXPECT_THAT([&] { read(); }, ThrowsMessage<InputError>(HasSubstr("holds no sensors")));
}

TEST_F(KalibrTest, NamesATimeShiftThatMayBeInMilliseconds) {
  recording_.write("imu.yaml", kImuOfKalibr);
  const auto findings = [&](const std::string& shift) {
    std::string chain = kCamchain;
    chain.replace(chain.find("0.0125"), 6, shift);
    recording_.write("../camchain-imucam.yaml", chain);
    diagnostics_ = {};
    read();
    return diagnostics_.count("time_offset_unit");
  };
  EXPECT_EQ(findings("4.2"), 1);
  EXPECT_EQ(diagnostics_.ranked().front().severity, Severity::Serious);
  EXPECT_THAT(diagnostics_.ranked().front().first_message,
              testing::AllOf(HasSubstr("timeshift_cam_imu' is 4.2 s"), HasSubstr("Seconds are due: 0.0042")));
  EXPECT_EQ(findings("-12.5"), 1);
  EXPECT_EQ(findings("-0.2"), 0);   // a slow link
  EXPECT_EQ(findings("1.4e9"), 0);  // the time of day and the time since a start
}

}  // namespace
}  // namespace lodeline

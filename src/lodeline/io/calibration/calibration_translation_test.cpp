#include "lodeline/io/calibration/calibration_translation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/io/euroc/test_euroc_rig.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

void expectSameRig(const RigFile& file, const RigFile& truth) {
  ASSERT_EQ(file.rig.cameras.size(), truth.rig.cameras.size());
  for (size_t i = 0; i < truth.rig.cameras.size(); ++i) {
    const CameraCalibration& camera = file.rig.cameras[i];
    const CameraCalibration& expected = truth.rig.cameras[i];
    EXPECT_EQ(camera.name, expected.name);
    const Rigid3 difference = camera.body_from_camera * expected.body_from_camera.inverse();
    EXPECT_LT(difference.translation.norm(), 1e-9) << camera.name;
    EXPECT_LT(difference.rotation.vec().norm(), 1e-9) << camera.name;
    EXPECT_EQ(camera.width_px, expected.width_px);
    EXPECT_EQ(camera.height_px, expected.height_px);
    EXPECT_EQ(camera.fx_px, expected.fx_px);
    EXPECT_EQ(camera.fy_px, expected.fy_px);
    EXPECT_EQ(camera.cx_px, expected.cx_px);
    EXPECT_EQ(camera.cy_px, expected.cy_px);
    EXPECT_EQ(camera.model, expected.model);
    ASSERT_GE(camera.distortion.size(), expected.distortion.size());
    for (size_t k = 0; k < camera.distortion.size(); ++k) {
      EXPECT_EQ(camera.distortion[k], k < expected.distortion.size() ? expected.distortion[k] : 0.0);
    }
    EXPECT_EQ(camera.time_offset_to_imu_s, expected.time_offset_to_imu_s);
  }
  ASSERT_TRUE(file.has_imu);
  const ImuNoise& noise = file.rig.imu.noise;
  const ImuNoise& expected = truth.rig.imu.noise;
  EXPECT_DOUBLE_EQ(noise.gyroscope_density_rad_per_s_sqrtHz, expected.gyroscope_density_rad_per_s_sqrtHz);
  EXPECT_DOUBLE_EQ(noise.gyroscope_random_walk_rad_per_s2_sqrtHz,
                   expected.gyroscope_random_walk_rad_per_s2_sqrtHz);
  EXPECT_DOUBLE_EQ(noise.accelerometer_density_m_per_s2_sqrtHz,
                   expected.accelerometer_density_m_per_s2_sqrtHz);
  EXPECT_DOUBLE_EQ(noise.accelerometer_random_walk_m_per_s3_sqrtHz,
                   expected.accelerometer_random_walk_m_per_s3_sqrtHz);
  EXPECT_FALSE(file.imu_correction);
}

class CalibrationTranslationTest : public testing::Test {
 protected:
  RigFile read(const std::string& name, const std::string& text) {
    place_.write(name, text);
    return readRigFiles({place_.path(name)}, &diagnostics_);
  }
  RigFile truth() { return read("truth.yaml", test::eurocRig()); }
  std::string refusal(const std::string& name, const std::string& text) {
    try {
      read(name, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  static std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }
  void writeVinsCameras() {
    for (size_t i = 0; i < 2; ++i) {
      place_.write(fmt::format("cam{}_pinhole.yaml", i), test::eurocVinsCamera(i));
    }
  }

  TestRecording place_;
  Diagnostics diagnostics_;
};

TEST_F(CalibrationTranslationTest, KalibrAndOpenVins) {
  const std::string chain =
      test::eurocChain("T_cam_imu", test::kLeftFromImu, "T_cn_cnm1", test::kRightFromLeft);
  expectSameRig(read("a.yaml", chain + "imu0:\n  T_i_b: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n" +
                                   std::string(test::kEurocImu).substr(6).replace(2, 7, "update_rate")),
                truth());
  const std::string inverse = test::eurocChain("T_imu_cam", test::kLeftPose, "T_imu_cam", test::kRightPose);
  place_.write("chain.yaml", "%YAML:1.0 # file type\n\n" + inverse);
  place_.write("imu.yaml", test::kKalibrImu);
  expectSameRig(
      read("estimator_config.yaml",
           "%YAML:1.0\nuse_fej: true\nrelative_config_imu: imu.yaml\nrelative_config_imucam: chain.yaml\n"),
      truth());
  const std::string mixed = test::eurocChain("T_cam_imu", test::kLeftFromImu, "T_imu_cam", test::kRightPose);
  place_.write("mixed.yaml", mixed + "T_imu_body:\n  [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\n");
  expectSameRig(readRigFiles({place_.path("mixed.yaml"), place_.path("imu.yaml")}, &diagnostics_), truth());
  EXPECT_EQ(diagnostics_.count("calibration_key"), 1) << "T_imu_body";
}

TEST_F(CalibrationTranslationTest, RefusesInversesThatContradict) {
  std::string both = test::eurocChain("T_cam_imu", test::kLeftFromImu, "T_imu_cam", test::kRightPose);
  both = replaced(both, "  cam_overlaps", fmt::format("  T_imu_cam: [{}]\n  cam_overlaps", test::kRightPose));
  EXPECT_THAT(refusal("a.yaml", both + std::string(test::kEurocImu)),
              HasSubstr("not the inverse of T_cam_imu"));
}

TEST_F(CalibrationTranslationTest, OrbSlam) {
  expectSameRig(read("orb.yaml", test::eurocOrbSlam()), truth());
  EXPECT_EQ(diagnostics_.count("calibration_translated"), 1);
  EXPECT_THAT(refusal("old.yaml", test::eurocOrbSlam() + "LEFT.K: [1]\n"), HasSubstr("version 0"));
  EXPECT_THAT(refusal("mono.yaml", replaced(test::eurocOrbSlam(), "IMU.T_b_c1", "IMU.T_x")),
              HasSubstr("settings without an IMU"));
  const RigFile fisheye = read("fisheye.yaml", R"(%YAML:1.0
Camera.type: "KannalaBrandt8"
Camera.fx: 190.9
Camera.fy: 190.8
Camera.cx: 254.9
Camera.cy: 256.9
Camera.k1: 0.0035
Camera.k2: 0.0007
Camera.k3: -0.002
Camera.k4: 0.0002
Camera.width: 512
Camera.height: 512
Camera.bf: 19.3
Camera2.fx: 190.4
Camera2.fy: 190.3
Camera2.cx: 252.6
Camera2.cy: 254.9
Camera2.k1: 0.0034
Camera2.k2: 0.0017
Camera2.k3: -0.0026
Camera2.k4: 0.0003
Tlr: !!opencv-matrix
  rows: 3
  cols: 4
  dt: f
  data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0]
Tbc: !!opencv-matrix
  rows: 4
  cols: 4
  dt: f
  data: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
IMU.NoiseGyro: 0.00016
IMU.NoiseAcc: 0.0028
IMU.GyroWalk: 0.000022
IMU.AccWalk: 0.00086
)");
  EXPECT_EQ(fisheye.rig.cameras.at(1).model, "equidistant");
  EXPECT_TRUE(fisheye.rig.cameras.at(1).body_from_camera.translation.isApprox(Vec3(0, 0.1, 0), 1e-12));
}

TEST_F(CalibrationTranslationTest, Okvis) {
  expectSameRig(read("okvis.yaml", test::eurocOkvis()), truth());
  const RigFile late =
      read("late.yaml", replaced(test::eurocOkvis(), "image_delay: 0.00", "image_delay: 0.02"));
  EXPECT_EQ(late.rig.cameras.at(0).time_offset_to_imu_s, -0.02) << "OKVIS subtracts it from the stamp";
  for (const char* unknown : {"mirror", "ds"}) {
    EXPECT_THAT(refusal("odd.yaml", replaced(test::eurocOkvis(), "distortion_type: radialtangential",
                                             fmt::format("distortion_type: {}", unknown))),
                HasSubstr(fmt::format("'{}', a camera model that Lodeline does not have", unknown)));
  }
}

TEST_F(CalibrationTranslationTest, Basalt) {
  expectSameRig(read("basalt.json", test::eurocBasalt()), truth());
  EXPECT_THAT(refusal("odd.json", replaced(test::eurocBasalt(), "pinhole-radtan8", "mirror")),
              AllOf(HasSubstr("'mirror', a camera model that Lodeline does not have"), HasSubstr("kb4")));
  EXPECT_THAT(refusal("ds.json", replaced(test::eurocBasalt(), "pinhole-radtan8", "ds")), HasSubstr("xi"));
  const RigFile sphere =
      read("sphere.json", replaced(test::eurocBasalt(), R"("pinhole-radtan8", "intrinsics": {)",
                                   R"("ds", "intrinsics": {"xi": -0.2, "alpha": 0.6, )"));
  EXPECT_EQ(sphere.rig.cameras.at(0).model, "double-sphere");
  EXPECT_THAT(sphere.rig.cameras.at(0).distortion, testing::ElementsAre(-0.2, 0.6));
  EXPECT_EQ(sphere.rig.cameras.at(0).fx_px, 458.654);
  const RigFile skewed =
      read("skewed.json",
           replaced(replaced(replaced(test::eurocBasalt(), "[0, 0, 0, 0, 0, 0, 0, 0, 0]",
                                      "[0.1, 0.2, 0.3, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06]"),
                             "[0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]",
                             "[0.001, 0.002, 0.003, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09]"),
                    "\"cam_time_offset_ns\": 0", "\"cam_time_offset_ns\": -2000000"));
  EXPECT_EQ(skewed.rig.cameras.at(0).time_offset_to_imu_s, -0.002);
  ASSERT_TRUE(skewed.imu_correction);
  const ImuSample raw{testTime(0), Vec3(1, 2, 3), Vec3(4, 5, 6)};
  const ImuSample sample = skewed.imu_correction->applied(raw);
  EXPECT_TRUE(sample.specific_force_B.isApprox(
      Vec3(4 * 1.01 - 0.1, 4 * 0.02 + 5 * 1.04 - 0.2, 4 * 0.03 + 5 * 0.05 + 6 * 1.06 - 0.3), 1e-12));
  EXPECT_TRUE(sample.angular_velocity_B.isApprox(
      Vec3(1 * 1.01 + 2 * 0.04 + 3 * 0.07 - 0.001, 1 * 0.02 + 2 * 1.05 + 3 * 0.08 - 0.002,
           1 * 0.03 + 2 * 0.06 + 3 * 1.09 - 0.003),
      1e-12));
}

TEST_F(CalibrationTranslationTest, Vins) {
  writeVinsCameras();
  const double root = std::sqrt(200.0);
  const std::string per_reading = fmt::format("acc_n: {}\ngyr_n: {}\nacc_w: {}\ngyr_w: {}\n", 2e-3 * root,
                                              1.6968e-4 * root, 3e-3 * root, 1.9393e-5 * root);
  const RigFile file = read("vins.yaml", test::eurocVins(per_reading));
  expectSameRig(file, truth());
  EXPECT_EQ(file.topics.at("cam1"), "/cam1/image_raw");
  EXPECT_EQ(file.topics.at("imu0"), "/imu0");
  const std::string densities = "acc_n: 2.0e-3\ngyr_n: 1.6968e-04\nacc_w: 3.0e-3\ngyr_w: 1.9393e-05\n";
  expectSameRig(read("densities.yaml", test::eurocVins(densities)), truth());
  EXPECT_EQ(diagnostics_.count("calibration_assumed"), 2);
  EXPECT_THAT(refusal("mounted.yaml", replaced(test::eurocVins(densities), "extrinsic: 0", "extrinsic: 2")),
              HasSubstr("does not know how the camera is mounted"));
  EXPECT_THAT(refusal("gone.yaml", replaced(test::eurocVins(densities), "cam1_pinhole", "cam1_none")),
              HasSubstr("cam1_none.yaml, which is missing"));
  place_.write("cam1_pinhole.yaml", replaced(test::eurocVinsCamera(1), "PINHOLE", "SCARAMUZZA"));
  EXPECT_THAT(refusal("odd.yaml", test::eurocVins(densities)), HasSubstr("'SCARAMUZZA', a camera model"));
}

TEST_F(CalibrationTranslationTest, VinsWithAMirror) {
  writeVinsCameras();
  place_.write(
      "cam1_pinhole.yaml",
      "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: camera\nimage_width: 752\nimage_height: 480\n"
      "mirror_parameters:\n   xi: 1.2\ndistortion_parameters:\n   k1: 0.01\n   k2: 0.02\n   p1: 0.003\n"
      "   p2: 0.004\nprojection_parameters:\n   gamma1: 900.0\n   gamma2: 901.0\n   u0: 370.0\n"
      "   v0: 240.0\n");
  const RigFile file = read("vins.yaml", test::eurocVins("acc_n: 2.0e-3\ngyr_n: 1.7e-04\nacc_w: 3.0e-3\n"
                                                         "gyr_w: 1.9e-05\n"));
  const CameraCalibration& camera = file.rig.cameras.at(1);
  EXPECT_EQ(camera.model, "unified");
  EXPECT_THAT(camera.distortion, testing::ElementsAre(1.2, 0.01, 0.02, 0.003, 0.004));
  EXPECT_EQ(camera.fy_px, 901.0);
  EXPECT_EQ(camera.cx_px, 370.0);
}

TEST_F(CalibrationTranslationTest, VinsMono) {
  const RigFile file = read(
      "mono.yaml",
      test::eurocVinsCamera(0) +
          "imu_topic: /imu0\nimage_topic: /cam0/image_raw\nextrinsicRotation: !!opencv-matrix\n   rows: 3\n"
          "   cols: 3\n   dt: d\n   data: [0.0148655429818, -0.999880929698, 0.00414029679422, "
          "0.999557249008, "
          "0.0149672133247, 0.025715529948, -0.0257744366974, 0.00375618835797, 0.999660727178]\n"
          "extrinsicTranslation: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n"
          "   data: [-0.0216401454975, -0.064676986768, 0.00981073058949]\n"
          "acc_n: 0.08\ngyr_n: 0.004\nacc_w: 0.00004\ngyr_w: 2.0e-6\ntd: 0.01\n");
  RigFile expected = truth();
  ASSERT_EQ(file.rig.cameras.size(), 1u);
  EXPECT_EQ(file.rig.cameras[0].fx_px, 458.654);
  EXPECT_EQ(file.rig.cameras[0].time_offset_to_imu_s, 0.01);
  EXPECT_TRUE(file.rig.cameras[0].body_from_camera.matrix().isApprox(
      expected.rig.cameras[0].body_from_camera.matrix(), 1e-9));
}

TEST_F(CalibrationTranslationTest, CameraInfoWithARigFileForTheRest) {
  std::vector<std::filesystem::path> files;
  for (size_t i = 0; i < 2; ++i) {
    const char* matrix = i == 0 ? "458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1"
                                : "457.587, 0, 379.999, 0, 456.134, 255.238, 0, 0, 1";
    files.push_back(place_.path(i == 0 ? "left.yaml" : "right.yaml"));
    place_.write(
        files.back().filename().string(),
        fmt::format("image_width: 752\nimage_height: 480\ncamera_name: {}\ncamera_matrix:\n  rows: 3\n"
                    "  cols: 3\n  data: [{}]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n"
                    "  rows: 1\n  cols: 5\n  data: [{}, 0]\n",
                    i == 0 ? "narrow_stereo/left" : "narrow_stereo/right", matrix, test::kDistortion[i]));
  }
  const std::string extrinsics = fmt::format("{}cam0: {{T_BS: [{}]}}\ncam1: {{T_BS: [{}]}}\n",
                                             test::kEurocImu, test::kLeftPose, test::kRightPose);
  place_.write("rest.yaml", extrinsics);
  std::swap(files[0], files[1]);  // the names decide, not the order
  files.push_back(place_.path("rest.yaml"));
  expectSameRig(readRigFiles(files, &diagnostics_), truth());
  EXPECT_THAT(refusal("cam0.yaml", place_.read("left.yaml")),
              HasSubstr("key 'cam0.T_BS' (camera to IMU) is missing"));
  EXPECT_THAT(refusal("cam12.yaml", place_.read("left.yaml")), HasSubstr("describes cam12 but not cam0"));
}

TEST_F(CalibrationTranslationTest, SaysWhatAnotherFileIs) {
  EXPECT_THAT(refusal("a.yaml", "front_end: {max_tracks: 3}\n"), HasSubstr("settings of Lodeline"));
  EXPECT_THAT(refusal("b.yaml", "iron_correction: [1]\nhard_iron_T: [1]\n"), HasSubstr("--mag-calibration"));
  EXPECT_THAT(refusal("c.yaml", "apples: 1\npears: 2\n"),
              AllOf(HasSubstr("its keys: apples, pears"), HasSubstr("lodeline rig-template")));
  EXPECT_THAT(refusal("d.yaml", "PK\3\4"), HasSubstr("is an archive (zip)"));
  EXPECT_THAT(refusal("e.yaml", "target_type: aprilgrid\n"), HasSubstr("calibration target"));
}

TEST_F(CalibrationTranslationTest, RigTextReadsBack) {
  writeVinsCameras();
  for (const auto& [name, text] :
       {std::pair("basalt.json", test::eurocBasalt()), std::pair("orb.yaml", test::eurocOrbSlam()),
        std::pair("okvis.yaml", test::eurocOkvis()), std::pair("own.yaml", test::eurocRig())}) {
    expectSameRig(read("again.yaml", rigText(read(name, text))), truth());
  }
  const std::string with_correction = replaced(test::eurocBasalt(), "[0, 0, 0, 0, 0, 0, 0, 0, 0]",
                                               "[0.1, 0.2, 0.3, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06]");
  const RigFile skewed = read("skewed.json", with_correction);
  const RigFile again = read("again.yaml", rigText(skewed));
  ASSERT_TRUE(skewed.imu_correction && again.imu_correction);
  EXPECT_TRUE(again.imu_correction->accelerometer.isApprox(skewed.imu_correction->accelerometer, 1e-12));
  EXPECT_TRUE(
      again.imu_correction->accelerometer_bias.isApprox(skewed.imu_correction->accelerometer_bias, 1e-12));
  EXPECT_EQ(read("template.yaml", rigTemplate()).rig.cameras.size(), 2u);
}

}  // namespace
}  // namespace lodeline

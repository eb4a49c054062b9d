#include "lodeline/io/calibration/rig_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/camera_keys.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr const char* kImu =
    "  gyroscope_noise_density: 1.0e-4\n  gyroscope_random_walk: 1.0e-5\n"
    "  accelerometer_noise_density: 1.0e-3\n  accelerometer_random_walk: 1.0e-4\n";
constexpr const char* kTransform = "[1,0,0,0.1, 0,1,0,0.2, 0,0,1,0.3, 0,0,0,1]";

class RigFileTest : public testing::Test {
 protected:
  RigFile read(const std::vector<std::string>& texts) {
    std::vector<std::filesystem::path> files;
    for (const std::string& text : texts) {
      const std::string name = "rig" + std::to_string(files.size()) + ".yaml";
      place_.write(name, text);
      files.push_back(place_.path(name));
    }
    return readRigFiles(files, &diagnostics_);
  }

  std::string refusal(const std::vector<std::string>& texts) {
    try {
      read(texts);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }

  TestRecording place_;
  Diagnostics diagnostics_;
  const std::string imu_ = std::string("imu0:\n  topic: /imu\n") + kImu;
  const std::string camera_ = std::string("cam0:\n  T_BS: ") + kTransform +
                              "\n  resolution: [640, 480]\n  intrinsics: [400, 401, 320, 240]\n"
                              "  distortion_model: none\n";
};

TEST_F(RigFileTest, ReadsOurOwnKeys) {
  const RigFile file = read({imu_ + camera_ + "pressure0:\n  T_BS: " + kTransform +
                             "\n  depth_noise_std: 0.01\n  water_density_kg_per_m3: 1025\n"});
  EXPECT_TRUE(file.has_imu);
  ASSERT_EQ(file.rig.cameras.size(), 1u);
  EXPECT_EQ(file.rig.cameras[0].fy_px, 401.0);
  EXPECT_EQ(file.rig.cameras[0].body_from_camera.translation, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(file.topics.at("imu0"), "/imu");
  EXPECT_FALSE(file.topics.contains("cam0"));
  EXPECT_TRUE(file.rig.pressure);
  EXPECT_NEAR(file.water.depth_m(101325.0 + 1025.0 * 9.80665 * 12.5), 12.5, 1e-9);
}

TEST_F(RigFileTest, SaysHowWellTheAxesOfTheImuAreKnown) {
  EXPECT_FALSE(read({imu_ + camera_}).rig.imu.noise.axes_sigma);
  const RigFile file = read({imu_ + "  axes_sigma: 0.02\n" + camera_});
  EXPECT_EQ(file.rig.imu.noise.axes_sigma, 0.02);
  EXPECT_EQ(read({rigText(file)}).rig.imu.noise.axes_sigma, 0.02);
  for (const char* wrong : {"0", "-0.01", "2", "nan"})
    EXPECT_THAT(refusal({imu_ + "  axes_sigma: " + wrong + "\n" + camera_}), HasSubstr("axes_sigma"))
        << wrong;
}

TEST_F(RigFileTest, ReadsTheShutterAndWritesItAgain) {
  const auto cameraWith = [&](const std::string& keys) {
    return read({imu_ + camera_ + keys}).rig.cameras.at(0);
  };
  EXPECT_FALSE(cameraWith("").hasRollingShutter());
  EXPECT_FALSE(cameraWith("  shutter: global\n").hasRollingShutter());
  const double rows = cameraWith("").height_px;
  EXPECT_DOUBLE_EQ(cameraWith("  shutter: rolling\n").line_delay_s, 0.0165 / rows);
  EXPECT_DOUBLE_EQ(cameraWith("  shutter: rolling\n").line_delay_sigma_s, 0.010 / rows);
  EXPECT_DOUBLE_EQ(cameraWith("  shutter: rolling\n  readout_s: 0.02\n").line_delay_s, 0.02 / rows);
  EXPECT_DOUBLE_EQ(cameraWith("  line_delay: 30000\n").line_delay_s, 3e-5);  // ns, Kalibr
  const RigFile file = read({imu_ + camera_ + "  line_delay_s: 3e-5\n  line_delay_sigma_s: 0\n"});
  EXPECT_EQ(file.rig.cameras.at(0).line_delay_s, 3e-5);
  EXPECT_EQ(file.rig.cameras.at(0).line_delay_sigma_s, 0.0);
  const CameraCalibration again = read({rigText(file)}).rig.cameras.at(0);
  EXPECT_EQ(again.line_delay_s, 3e-5);
  EXPECT_EQ(again.line_delay_sigma_s, 0.0);
  EXPECT_THAT(refusal({imu_ + camera_ + "  shutter: slow\n"}), HasSubstr("global or rolling"));
  EXPECT_THAT(refusal({imu_ + camera_ + "  line_delay_s: 30000\n"}), HasSubstr("nanoseconds"));
  EXPECT_THAT(refusal({imu_ + camera_ + "  readout_s: -1\n"}), HasSubstr("readout_s"));
}

TEST_F(RigFileTest, IsReadAsARigOfCamerasAndImu) {
  const auto readAsRig = [&](const std::string& text) {
    place_.write("rig.yaml", text);
    return readRig(std::vector<std::filesystem::path>{place_.path("rig.yaml")}, &diagnostics_);
  };
  EXPECT_EQ(readAsRig(imu_ + camera_).rig.cameras.size(), 1u);
  EXPECT_THROW(readAsRig(imu_), InputError);
  EXPECT_THROW(readAsRig(camera_), InputError);
}

TEST_F(RigFileTest, ReadsKalibrsFiles) {
  const RigFile file = read(
      {std::string("cam0:\n  rostopic: /left\n  T_cam_imu: ") + kTransform +
           "\n  camera_model: pinhole\n  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
           "  intrinsics: [400, 401, 320, 240]\n  resolution: [640, 480]\n  timeshift_cam_imu: 0.01\n",
       "rostopic: /imu\nupdate_rate: 200\ngyroscope_noise_density: 1.0e-4\ngyroscope_random_walk: 1.0e-5\n"
       "accelerometer_noise_density: 1.0e-3\naccelerometer_random_walk: 1.0e-4\n"});
  EXPECT_TRUE(file.has_imu);
  EXPECT_EQ(file.rig.imu.rate_hz, 200.0);
  EXPECT_EQ(file.topics.at("cam0"), "/left");
  EXPECT_EQ(file.topics.at("imu0"), "/imu");
  EXPECT_EQ(file.rig.cameras.at(0).body_from_camera.translation, Vec3(-0.1, -0.2, -0.3));
  EXPECT_EQ(file.rig.cameras.at(0).time_offset_to_imu_s, 0.01);
}

TEST_F(RigFileTest, MovesSensorsToTheImuFrame) {
  const RigFile file = read({imu_ + "  T_BS: " + kTransform + "\n" + camera_});
  EXPECT_NEAR(file.rig.cameras.at(0).body_from_camera.translation.norm(), 0.0, 1e-15);
}

TEST_F(RigFileTest, NamesTheNearestKeyForAnUnknownOne) {
  EXPECT_THAT(refusal({imu_ + camera_ + "  intrinsic: [1, 2]\n"}),
              HasSubstr("unknown key 'cam0.intrinsic'; did you mean 'intrinsics'?"));
  EXPECT_THAT(refusal({imu_ + "img0: {}\n"}), HasSubstr("unknown sensor 'img0'; did you mean 'imu0'?"));
}

TEST_F(RigFileTest, RefusesContradictionsAndGaps) {
  EXPECT_THAT(refusal({imu_, imu_}), HasSubstr("describes imu0, which"));
  std::string second = camera_;
  second.replace(0, 4, "cam1");
  EXPECT_THAT(refusal({imu_ + second}), HasSubstr("describes cam1 but not cam0"));
  EXPECT_THAT(refusal({"- a list\n"}), HasSubstr("holds no sensors"));
}

TEST_F(RigFileTest, RefusesSectionsThatAreNoMaps) {
  EXPECT_THAT(refusal({imu_ + "cam0: 7\n"}), HasSubstr("rig0.yaml"));
  EXPECT_THAT(refusal({imu_ + "cam00: {}\n"}), HasSubstr("cam00"));
}

TEST_F(RigFileTest, DepthInDecimalsSurvivesBeingAPressure) {
  const WaterColumn water;
  for (const double depth_m : {0.0, 7.48, 12.345678, -0.25, 101.000001}) {
    EXPECT_EQ(water.depth_m(water.pressure_Pa(depth_m)), depth_m);
  }
}

TEST_F(RigFileTest, ReadsPortsAndWritesThemAgain) {
  const std::string flat =
      "  port: {type: flat, normal: [0.02, 0, 2], distance_m: 0.015, thickness_m: 0.008}\n";
  const std::string dome =
      "  port: {type: dome, centre_m: [0, 0.001, 0.002], radius_m: 0.05, thickness_m: 0.006, indices: [1, "
      "1.52, "
      "1.34]}\n";
  const RigFile one = read({imu_ + camera_ + flat});
  const Port& plate = one.rig.cameras[0].port.value();
  EXPECT_EQ(plate.type, Port::Type::Flat);
  EXPECT_LT((plate.normal_C - Vec3(0.01, 0.0, 1.0).normalized()).norm(), 1e-15);
  EXPECT_EQ(plate.distance_m, 0.015);
  EXPECT_EQ(plate.thickness_m, 0.008);
  EXPECT_EQ(plate.index_glass, 1.49);
  EXPECT_EQ(plate.index_water, 1.333);
  const RigFile other = read({imu_ + camera_ + dome});
  const Port& sphere = other.rig.cameras[0].port.value();
  EXPECT_EQ(sphere.type, Port::Type::Dome);
  EXPECT_EQ(sphere.centre_C, Vec3(0.0, 0.001, 0.002));
  EXPECT_EQ(sphere.radius_m, 0.05);
  EXPECT_EQ(sphere.index_glass, 1.52);
  EXPECT_EQ(sphere.index_water, 1.34);
  for (const RigFile* file : {&one, &other}) {
    const RigFile again = read({rigText(*file)});
    const Port &before = *file->rig.cameras[0].port, &after = again.rig.cameras[0].port.value();
    EXPECT_EQ(portText(after), portText(before));
  }
  EXPECT_FALSE(read({imu_ + camera_}).rig.cameras[0].port);
}

TEST_F(RigFileTest, NamesWhatIsWrongWithAPort) {
  const auto with = [this](const std::string& port) {
    return refusal({imu_ + camera_ + "  port: " + port + "\n"});
  };
  const std::string plate = "distance_m: 0.01, thickness_m: 0.01";
  EXPECT_THAT(with("{type: bent, " + plate + "}"), HasSubstr("must be flat or dome"));
  EXPECT_THAT(with("{" + plate + "}"), HasSubstr("'cam0.port.type' is missing"));
  EXPECT_THAT(with("{type: flat, thickness_m: 0.01}"), HasSubstr("distance_m"));
  EXPECT_THAT(with("{type: flat, " + plate + ", normal: [0, 0, -1]}"),
              HasSubstr("points away from the view"));
  EXPECT_THAT(with("{type: flat, " + plate + ", normal: [0, 0, 0]}"), HasSubstr("is no direction"));
  EXPECT_THAT(with("{type: flat, " + plate + ", normal: [0, 1]}"), HasSubstr("has 2 numbers"));
  EXPECT_THAT(with("{type: flat, " + plate + ", indices: [1, 1.5]}"), HasSubstr("air, glass and water"));
  EXPECT_THAT(with("{type: flat, " + plate + ", indices: [1, 1.5, 0.9]}"),
              HasSubstr("index of water is 0.9"));
  EXPECT_THAT(with("{type: flat, " + plate + ", radius_m: 0.05}"),
              HasSubstr("unknown key 'cam0.port.radius_m'"));
  EXPECT_THAT(with("{type: dome, centre_m: [0, 0, 0.06], radius_m: 0.05, thickness_m: 0.005}"),
              HasSubstr("outside of it"));
  EXPECT_THAT(with("flat"), HasSubstr("holds no keys"));
}

}  // namespace
}  // namespace lodeline

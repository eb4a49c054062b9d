#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "lodeline/inspection/inspection_report.h"
#include "lodeline/inspection/start_check.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/util/files/test_data.h"

// Tests on a real recording without faults, and on copies of it with one fault each.

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using Lines = std::vector<std::string>;
using Numbers = std::vector<double>;

class InspectionTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = std::filesystem::temp_directory_path() / ("lodeline_inspection_" + name);
    std::filesystem::remove_all(folder_);
    for (const char* sensor : {"imu0", "cam0"}) {
      std::filesystem::create_directories(path(sensor));
      for (const char* file : {"data.csv", "sensor.yaml"}) {
        std::filesystem::copy_file(*recording / "mav0" / sensor / file, path(sensor) / file);
      }
    }
    std::filesystem::create_directory_symlink(*recording / "mav0" / "cam0" / "data", path("cam0") / "data");
    writeMagnetometer(*recording / "mav0" / "state_groundtruth_estimate0" / "gt_tum.txt");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path path(const std::string& sensor) const { return folder_ / "mav0" / sensor; }
  std::filesystem::path csv(const std::string& sensor) const { return path(sensor) / "data.csv"; }

  /// Writes magnetometer readings, which the recording lacks: a constant field in the true attitudes.
  void writeMagnetometer(const std::filesystem::path& truth) const {
    std::filesystem::create_directories(path("mag0"));
    std::ofstream(path("mag0") / "sensor.yaml")
        << "T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nmagnetometer_noise_density: 1.0e-8\n";
    std::ofstream list(csv("mag0"));
    list << "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
    std::ifstream stream(truth);
    int row = 0;
    for (std::string line; std::getline(stream, line);) {
      std::istringstream fields(line);
      long double time_s = 0.0L;
      Vec3 p, q;
      double w = 1.0;
      if (!(fields >> time_s >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> w) || row++ % 4 != 0)
        continue;
      const Vec3 field = Quat(w, q.x(), q.y(), q.z()).normalized().conjugate() * Vec3(2e-6, 2.3e-5, -3.9e-5);
      list << fmt::format("{},{:.9e},{:.9e},{:.9e}\n", static_cast<int64_t>(time_s * 1e9L + 0.5L), field.x(),
                          field.y(), field.z());
    }
  }

  static void edit(const std::filesystem::path& file, const std::function<void(Lines*)>& change) {
    Lines lines;
    {
      std::ifstream stream(file);
      for (std::string line; std::getline(stream, line);) lines.push_back(line);
    }
    change(&lines);
    std::ofstream stream(file);
    for (const std::string& line : lines) stream << line << "\n";
  }

  /// Changes the numbers after the time stamp of every row.
  static void editNumbers(const std::filesystem::path& file,
                          const std::function<void(size_t row, Numbers*)>& change) {
    edit(file, [&](Lines* lines) {
      for (size_t i = 1; i < lines->size(); ++i) {
        std::istringstream fields((*lines)[i]);
        std::string stamp, field;
        std::getline(fields, stamp, ',');
        Numbers numbers;
        while (std::getline(fields, field, ',')) numbers.push_back(std::stod(field));
        change(i - 1, &numbers);
        (*lines)[i] = stamp;
        for (const double number : numbers) (*lines)[i] += fmt::format(",{}", number);
      }
    });
  }

  void addCamera1() const {
    std::filesystem::create_directories(path("cam1"));
    const std::filesystem::path recorded = *testData(kMh01Recording) / "mav0" / "cam1";
    for (const char* file : {"data.csv", "sensor.yaml"}) {
      std::filesystem::copy_file(recorded / file, path("cam1") / file);
    }
    std::filesystem::create_directory_symlink(recorded / "data", path("cam1") / "data");
  }

  /// Rotates the camera of the calibration.
  void turnCamera(double angle_deg, const Vec3& axis_C) const {
    changeCamera(0, [&](const Rigid3& pose) {
      const Quat turn(Eigen::AngleAxisd(angle_deg * M_PI / 180.0, axis_C));
      return Rigid3(pose.rotation * turn, pose.translation);
    });
  }

  /// Changes T_BS.
  void changeCamera(size_t index, const std::function<Rigid3(const Rigid3&)>& change) const {
    Diagnostics diagnostics;
    const EurocSource source(folder_, {}, &diagnostics);
    const Rigid3 pose = change(source.rig().cameras[index].body_from_camera);
    edit(path(fmt::format("cam{}", index)) / "sensor.yaml", [&](Lines* lines) {
      bool inside = false;
      std::erase_if(*lines, [&](const std::string& line) {
        if (!line.empty() && line[0] != ' ') inside = line.starts_with("T_BS");
        return inside;
      });
      std::string text = "T_BS: [";
      for (int i = 0; i < 16; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", pose.matrix()(i / 4, i % 4));
      lines->push_back(text + "]");
    });
  }

  StartCheck checkFirstSeconds(Diagnostics* diagnostics) const {
    EurocOptions options;
    options.camera_indices = {0};
    return checkStart(
        [&](Diagnostics* unheard) { return std::make_unique<EurocSource>(folder_, options, unheard); },
        folder_.string(), StartCheckOptions(), diagnostics);
  }

  std::string inspected() const {
    EurocOptions whatever;
    whatever.needs_cameras = whatever.needs_imu = whatever.needs_calibration = false;
    const Inspection inspection = inspect(
        [&](Diagnostics* diagnostics) {
          return std::make_unique<EurocSource>(folder_, whatever, diagnostics);
        },
        InspectionOptions());
    return inspectionText(inspection);
  }

  /// The fault must be named in the first three lines.
  void expectNamed(const std::string& fault) const {
    const std::string text = inspected();
    size_t end = 0;
    for (int line = 0; line < 3 && end != std::string::npos; ++line) end = text.find('\n', end + 1);
    EXPECT_THAT(text.substr(0, end), HasSubstr(fault)) << text;
  }

  std::filesystem::path folder_;
};

TEST_F(InspectionTest, FindsNothingInASoundRecording) {
  EXPECT_THAT(inspected(), HasSubstr("nothing found that would hurt"));
}

TEST_F(InspectionTest, NamesExchangedAxes) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) {
    std::swap((*n)[0], (*n)[1]);
    std::swap((*n)[3], (*n)[4]);
  });
  expectNamed("swapped");
}

TEST_F(InspectionTest, NamesDegreesPerSecond) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) {
    for (size_t i = 0; i < 3; ++i) (*n)[i] *= 180.0 / M_PI;
  });
  expectNamed("the gyroscope is in deg/s");
}

TEST_F(InspectionTest, NamesAccelerationsInG) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) {
    for (size_t i = 3; i < 6; ++i) (*n)[i] /= 9.80665;
  });
  expectNamed("the accelerometer is in g");
}

TEST_F(InspectionTest, NamesALagOfTheCamera) {
  edit(csv("cam0"), [](Lines* lines) {
    for (size_t i = 1; i < lines->size(); ++i) {
      (*lines)[i] = fmt::format("{}{}", std::stoll((*lines)[i]) + 20'000'000,
                                (*lines)[i].substr((*lines)[i].find(',')));
    }
  });
  expectNamed("time offset: the images' stamps lag behind");
}

TEST_F(InspectionTest, NamesExtrinsicsTenDegreesOff) {
  turnCamera(10.0, Vec3::UnitY());
  expectNamed("extrinsics: the camera's rotation to the IMU is");
}

TEST_F(InspectionTest, NamesImagesUpsideDown) {
  turnCamera(180.0, Vec3::UnitZ());
  expectNamed("upside down");
}

TEST_F(InspectionTest, NamesADeadAxis) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) { (*n)[1] = 0.0; });
  expectNamed("the gyroscope's y axis is dead");
}

TEST_F(InspectionTest, NamesDuplicatedStamps) {
  edit(csv("imu0"), [](Lines* lines) {
    Lines doubled;
    for (size_t i = 0; i < lines->size(); ++i) {
      doubled.push_back((*lines)[i]);
      if (i % 20 == 5) doubled.push_back((*lines)[i]);
    }
    *lines = doubled;
  });
  expectNamed("duplicated stamps");
}

TEST_F(InspectionTest, NamesDisorder) {
  edit(csv("imu0"), [](Lines* lines) {
    for (size_t i = 20; i + 1 < lines->size(); i += 40) std::swap((*lines)[i], (*lines)[i + 1]);
  });
  expectNamed("stamps out of order");
}

TEST_F(InspectionTest, NamesGaps) {
  edit(csv("imu0"), [](Lines* lines) {
    Lines kept;
    for (size_t i = 0; i < lines->size(); ++i) {
      if (i % 1000 < 960) kept.push_back((*lines)[i]);
    }
    *lines = kept;
  });
  expectNamed("imu0: gaps");
}

TEST_F(InspectionTest, NamesTheMagnetometersUnit) {
  editNumbers(csv("mag0"), [](size_t, Numbers* n) {
    for (double& value : *n) value *= 1e6;
  });
  expectNamed("the magnetometer is in");
}

TEST_F(InspectionTest, NamesExchangedAxesOfTheMagnetometer) {
  editNumbers(csv("mag0"), [](size_t, Numbers* n) { std::swap((*n)[0], (*n)[1]); });
  expectNamed("the axes of the magnetometer do not fit the gyroscope's");
}

TEST_F(InspectionTest, NamesAWrongSignOfTheMagnetometer) {
  editNumbers(csv("mag0"), [](size_t, Numbers* n) { (*n)[2] *= -1.0; });
  expectNamed("the axes of the magnetometer do not fit the gyroscope's");
}

TEST_F(InspectionTest, FindsNothingInASoundStereoRecording) {
  addCamera1();
  EXPECT_THAT(inspected(), HasSubstr("nothing found that would hurt"));
}

TEST_F(InspectionTest, NamesSwappedCameras) {
  addCamera1();
  std::filesystem::rename(path("cam0") / "sensor.yaml", folder_ / "sensor.yaml");
  std::filesystem::rename(path("cam1") / "sensor.yaml", path("cam0") / "sensor.yaml");
  std::filesystem::rename(folder_ / "sensor.yaml", path("cam1") / "sensor.yaml");
  expectNamed("left and right camera swapped");
}

TEST_F(InspectionTest, NamesABaselineInMillimetres) {
  addCamera1();
  for (const size_t camera : {0, 1}) {
    changeCamera(camera, [](const Rigid3& pose) { return Rigid3(pose.rotation, 1e3 * pose.translation); });
  }
  expectNamed("wrong unit (m, not mm)");
}

TEST_F(InspectionTest, NamesAnInvertedTransform) {
  changeCamera(0, [](const Rigid3& pose) { return pose.inverse(); });
  expectNamed("T_BS inverted would fit");
}

TEST_F(InspectionTest, NamesGravityThatPointsUp) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) {
    for (size_t i = 3; i < 6; ++i) (*n)[i] *= -1.0;
  });
  expectNamed("gravity points to the top of the images");
}

TEST_F(InspectionTest, LooksAtWhatIsThere) {
  std::filesystem::remove_all(path("cam0"));
  EXPECT_THAT(inspected(), AllOf(HasSubstr("nothing found that would hurt"), HasSubstr("there are no images"),
                                 HasSubstr("imu0      good"), HasSubstr("mag0      good")));
  std::filesystem::remove_all(path("imu0"));
  EXPECT_THAT(inspected(), AllOf(HasSubstr("there are no inertial readings"), HasSubstr("mag0      good")));
}

TEST_F(InspectionTest, NamesMissingImagesAndCalibrations) {
  std::filesystem::remove(path("cam0") / "data");
  EXPECT_THAT(inspected(), HasSubstr("images looked at are missing"));
  for (const char* sensor : {"cam0", "imu0", "mag0"}) std::filesystem::remove(path(sensor) / "sensor.yaml");
  EXPECT_THAT(inspected(),
              AllOf(HasSubstr("cam0/sensor.yaml: calibration file missing"),
                    HasSubstr("imu0/sensor.yaml: calibration file missing"), HasSubstr("imu0      good")));
}

TEST_F(InspectionTest, NamesAFrozenMagnetometer) {
  Numbers held;
  editNumbers(csv("mag0"), [&](size_t row, Numbers* n) {
    if (row == 100) held = *n;
    if (row > 100) *n = held;
  });
  expectNamed("mag0: frozen");
}

TEST_F(InspectionTest, NamesAWrongFocalLength) {
  edit(path("cam0") / "sensor.yaml", [](Lines* lines) {
    for (std::string& line : *lines) {
      if (line.starts_with("intrinsics")) line = "intrinsics: [570.0, 570.0, 367.2, 248.4]";
    }
  });
  expectNamed("the focal length is wrong");
}

TEST_F(InspectionTest, NamesAWildReading) {
  editNumbers(csv("imu0"), [](size_t row, Numbers* n) {
    if (row == 1000) (*n)[3] = 1e6;
  });
  expectNamed("beyond what any inertial sensor can measure");
}

TEST_F(InspectionTest, NamesNoiseDensitiesOfNearlyZero) {
  edit(path("imu0") / "sensor.yaml", [](Lines* lines) {
    for (std::string& line : *lines) {
      if (line.starts_with("gyroscope_noise_density")) line = "gyroscope_noise_density: 1.7e-10";
      if (line.starts_with("accelerometer_noise_density")) line = "accelerometer_noise_density: 2.0e-4";
    }
  });
  const std::string text = inspected();
  EXPECT_THAT(text, HasSubstr("no gyroscope has a noise density of 1.7e-10"));
}

TEST_F(InspectionTest, StartCheckFindsNothingInTheSoundRecording) {
  Diagnostics diagnostics;
  const StartCheck check = checkFirstSeconds(&diagnostics);
  EXPECT_TRUE(diagnostics.ranked().empty()) << diagnostics.ranked().front().first_message;
  EXPECT_EQ(check.rate_to_SI, 1.0);
  EXPECT_NEAR(check.noise.gyroscope_rad_per_s_sqrtHz, 1.0e-4, 0.3e-4);
  EXPECT_NEAR(check.noise.accelerometer_m_per_s2_sqrtHz, 1.5e-3, 0.5e-3);
}

TEST_F(InspectionTest, StartCheckFindsAnImuInOtherAxesThanTheCameras) {
  editNumbers(csv("imu0"),
              [](size_t, Numbers* n) { *n = {(*n)[1], -(*n)[0], (*n)[2], (*n)[4], -(*n)[3], (*n)[5]}; });
  Diagnostics diagnostics;
  checkFirstSeconds(&diagnostics);
  EXPECT_EQ(diagnostics.count("extrinsics_rotation"), 1);
  ASSERT_EQ(diagnostics.count(kSensorsContradict), 1);
  std::string messages;
  for (const Finding& finding : diagnostics.ranked()) messages += finding.first_message + "\n";
  EXPECT_THAT(messages,
              AllOf(HasSubstr("images and gyroscope contradict each other"), HasSubstr("lodeline inspect")));
}

TEST_F(InspectionTest, StartCheckFindsAGyroscopeInDegrees) {
  editNumbers(csv("imu0"), [](size_t, Numbers* n) {
    for (size_t i = 0; i < 3; ++i) (*n)[i] *= 180.0 / M_PI;
  });
  Diagnostics diagnostics;
  EXPECT_NEAR(checkFirstSeconds(&diagnostics).rate_to_SI, M_PI / 180.0, 1e-9);
  EXPECT_EQ(diagnostics.count("gyroscope_unit"), 1);
  EXPECT_EQ(diagnostics.count(kSensorsContradict), 0);
}

}  // namespace
}  // namespace lodeline

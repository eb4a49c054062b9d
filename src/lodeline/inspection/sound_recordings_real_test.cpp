#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include "lodeline/inspection/inspection_report.h"
#include "lodeline/io/logs/log_source.h"
#include "lodeline/util/files/test_data.h"

// Recordings without faults and images, from other manufacturers and sensors: there must be no findings.

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// A gzipped CSV file with one row per reading.
struct SoundRecording {
  const char* name;
  const char* file;    ///< in testDataDir()
  const char* header;  ///< replaces the file's own; empty to keep that
  double rate_hz;      ///< where the file has no time, else 0
};

class SoundRecordings : public testing::TestWithParam<SoundRecording> {
 protected:
  void SetUp() override {
    const auto packed = testData(GetParam().file);
    if (!packed) GTEST_SKIP() << missingTestData(GetParam().file);
    file_ =
        std::filesystem::temp_directory_path() / (std::string("lodeline_sound_") + GetParam().name + ".csv");
    unpack(*packed);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  std::filesystem::path file_;

 private:
  void unpack(const std::filesystem::path& packed) const {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
        popen(("gzip -dc '" + packed.string() + "'").c_str(), "r"), &pclose);
    ASSERT_TRUE(pipe);
    std::ofstream plain(file_);
    std::array<char, 4096> line;
    for (int row = -1; std::fgets(line.data(), line.size(), pipe.get()) != nullptr; ++row) {
      if (row < 0 && *GetParam().header != '\0') {
        plain << GetParam().header << "\n";
        continue;
      }
      if (row >= 0 && GetParam().rate_hz > 0.0) plain << std::to_string(row / GetParam().rate_hz) << ",";
      plain << line.data();
    }
  }
};

TEST_P(SoundRecordings, NothingIsFoundWrong) {
  const Inspection inspection =
      inspect([&](Diagnostics* diagnostics) { return std::make_unique<LogSource>(file_, diagnostics); },
              InspectionOptions());
  EXPECT_THAT(inspectionText(inspection),
              AllOf(StartsWith("nothing found that would hurt"), HasSubstr("there are no images"),
                    HasSubstr("imu0      good")));
}

constexpr const char* kBroadColumns =
    "t [s],gx [rad/s],gy [rad/s],gz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2],mx [uT],my [uT],mz [uT],"
    "q1,q2,q3,q4,p1,p2,p3,n";
constexpr double kBroadRate_hz = 285.7142857;

INSTANTIATE_TEST_SUITE_P(
    All, SoundRecordings,
    testing::Values(SoundRecording{"slow_rotation", "broad/02_undisturbed_slow_rotation_B.csv.gz",
                                   kBroadColumns, kBroadRate_hz},
                    SoundRecording{"fast_rotation", "broad/07_undisturbed_fast_rotation_B.csv.gz",
                                   kBroadColumns, kBroadRate_hz},
                    SoundRecording{"fast_translation", "broad/16_undisturbed_fast_translation_B.csv.gz",
                                   kBroadColumns, kBroadRate_hz},
                    SoundRecording{"beside_a_magnet", "broad/28_disturbed_stationary_magnet_A.csv.gz",
                                   kBroadColumns, kBroadRate_hz},
                    SoundRecording{"demonstration", "magcal/xio_fusion_sensor_data.csv.gz", "", 0.0},
                    SoundRecording{"flight", "euroc_imu_gt/V1_03_difficult_imu0.csv.gz", "", 0.0}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace lodeline

#include <sstream>

#include "apps/lodeline/tests/test_room.h"

// Tests of `lodeline run` on lists of readings that are empty, truncated, out of order or full of gaps.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class RunReadings : public RoomTest {
 protected:
  /// Sigma of the last pose's position along x, from states.csv.
  double lastSigma_m() const {
    std::istringstream lines(readText(output_ / "states.csv"));
    std::string header, line, last;
    std::getline(lines, header);
    while (std::getline(lines, line)) last = line;
    const auto columns = [](const std::string& text) {
      std::vector<std::string> fields;
      std::istringstream stream(text);
      for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
      return fields;
    };
    const std::vector<std::string> names = columns(header), values = columns(last);
    for (size_t i = 0; i < names.size(); ++i) {
      if (names[i].starts_with("sigma_p_x")) return std::stod(values[i]);
    }
    return -1.0;
  }
};

void expectNamed(const Execution& result, const std::filesystem::path& file, int line) {
  EXPECT_THAT(result.output, HasSubstr(fmt::format("{}:{}", file.string(), line)));
}

TEST_F(RunReadings, UndamagedRecordingIsTracked) {
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(summary()["findings"].size(), 0u) << summary().dump(2);
  EXPECT_EQ(summary()["rig"]["cameras"].size(), 2u);
  EXPECT_LT(error_m(), 0.004);
}

TEST_F(RunReadings, EmptyListIsBadInput) {
  for (const char* sensor : {"imu0", "cam0", "cam1"}) {
    const std::string content = readText(recording_.csv(sensor));
    for (const std::string& empty : {std::string(), content.substr(0, content.find('\n') + 1)}) {
      std::ofstream(recording_.csv(sensor)) << empty;
      const Execution result = run();
      EXPECT_EQ(result.exit_code, 1);
      EXPECT_THAT(result.output,
                  AllOf(HasSubstr(recording_.csv(sensor).string()), HasSubstr("no usable row")));
    }
    std::ofstream(recording_.csv(sensor)) << content;
  }
}

TEST_F(RunReadings, MissingListIsBadInput) {
  std::filesystem::remove(recording_.csv("imu0"));
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr(recording_.csv("imu0").string()));
}

TEST_F(RunReadings, TruncatedLineIsNamedAndPassedOver) {
  editLines(recording_.csv("imu0"), [](auto& lines) { lines[200].resize(lines[200].size() / 2); });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("csv_row"), 1);
  expectNamed(result, recording_.csv("imu0"), 201);
}

TEST_F(RunReadings, ListCutOffInItsLastLineIsUsedUpToThere) {
  const auto size = std::filesystem::file_size(recording_.csv("imu0"));
  std::filesystem::resize_file(recording_.csv("imu0"), size - 30);
  const Execution result = run();
  expectGoodResult(result, kRoomImages - 1);
  EXPECT_EQ(findings("csv_row"), 1);
  EXPECT_THAT(result.output, HasSubstr("cut off"));
}

TEST_F(RunReadings, LineEndsOfWindowsChangeNothing) {
  ASSERT_EQ(run().exit_code, 0);
  const std::string unix_result = readText(output_ / "trajectory.tum") + readText(output_ / "states.csv");
  for (const char* sensor : {"imu0", "cam0", "cam1"}) {
    for (const char* file : {"data.csv", "sensor.yaml"}) {
      editLines(recording_.sensor(sensor) / file, [](auto& lines) {
        for (std::string& line : lines) line += '\r';
      });
    }
  }
  ASSERT_EQ(run().exit_code, 0);
  EXPECT_EQ(readText(output_ / "trajectory.tum") + readText(output_ / "states.csv"), unix_result);
  EXPECT_EQ(summary()["findings"].size(), 0u);
}

TEST_F(RunReadings, NanIsNamedAndPassedOver) {
  editLines(recording_.csv("imu0"), [](auto& lines) {
    lines[150] = lines[150].substr(0, lines[150].find(',')) + ",nan,0,0,0,0,9.8";
    lines[250] = lines[250].substr(0, lines[250].rfind(',')) + ",inf";
  });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("csv_row"), 2);
  expectNamed(result, recording_.csv("imu0"), 151);
}

TEST_F(RunReadings, TimeGoingBackwardsIsReportedWithBothStamps) {
  editLines(recording_.csv("imu0"), [](auto& lines) { std::swap(lines[180], lines[183]); });
  editLines(recording_.csv("cam0"), [](auto& lines) { std::swap(lines[12], lines[13]); });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_GE(findings("imu_disorder"), 1);
  EXPECT_EQ(findings("image_disorder"), 1);
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("time goes backwards"), HasSubstr("from stamp 0:00.600 to 0:00.550")));
}

TEST_F(RunReadings, RepeatedStampIsReported) {
  editLines(recording_.csv("imu0"), [](auto& lines) { lines.insert(lines.begin() + 120, lines[120]); });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("imu_duplicate"), 1);
}

TEST_F(RunReadings, InertialGapOfHalfASecondIsReportedAndSurvived) {
  // From 0.4 s after the first image on; the header is line 0, images begin at line 101.
  editLines(recording_.csv("imu0"),
            [](auto& lines) { lines.erase(lines.begin() + 182, lines.begin() + 281); });
  const Execution result = run();
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(findings("imu_gap"), 1);
  EXPECT_THAT(result.output, HasSubstr("nothing for 0.500 s after stamp"));
  EXPECT_EQ(poses(), kRoomImages);
  // Images determine the motion in the gap; interpolated inertial readings in it must not be used.
  EXPECT_LT(error_m(), 0.02);
}

TEST_F(RunReadings, AReadingThatNoSensorGivesIsLeftOutAndNamed) {
  const std::string good = readText(recording_.csv("imu0"));
  for (const char* value : {"1000", "1e6", "-1e30", "1e300"}) {
    for (const size_t column : {1, 4}) {
      std::ofstream(recording_.csv("imu0")) << good;
      editLines(recording_.csv("imu0"), [&](auto& lines) {
        size_t begin = 0;
        for (size_t i = 0; i < column; ++i) begin = lines[200].find(',', begin) + 1;
        lines[200].replace(begin, lines[200].find(',', begin) - begin, value);
      });
      const Execution result = run();
      expectGoodResult(result);
      EXPECT_EQ(findings("imu_impossible"), 1) << value;
      EXPECT_THAT(result.output, HasSubstr("beyond what any inertial sensor can measure"));
    }
  }
}

TEST_F(RunReadings, AStuckImuIsAGapWithWords) {
  editLines(recording_.csv("imu0"), [](auto& lines) {
    for (size_t i = 182; i < 282; ++i)
      lines[i].replace(lines[i].find(','), std::string::npos, lines[181].substr(lines[181].find(',')));
  });
  const Execution result = run();
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(findings("imu_unusable"), 1);
  EXPECT_EQ(poses(), kRoomImages);
  EXPECT_LT(error_m(), 0.02);
}

TEST_F(RunReadings, AnImuOfZerosIsBadInput) {
  editLines(recording_.csv("imu0"), [](auto& lines) {
    for (size_t i = 1; i < lines.size(); ++i)
      lines[i] = lines[i].substr(0, lines[i].find(',')) + ",0,0,0,0,0,0";
  });
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1) << result.output;
  EXPECT_THAT(readText(output_ / "run.json"), HasSubstr("zero in every axis"));
}

TEST_F(RunReadings, AnAccelerometerInGIsConvertedWithWords) {
  editLines(recording_.csv("imu0"), [](auto& lines) {
    for (size_t i = 1; i < lines.size(); ++i) {
      std::istringstream fields(lines[i]);
      std::string row, field;
      for (int column = 0; std::getline(fields, field, ','); ++column) {
        if (column > 0) row += ',';
        row += column > 3 ? fmt::format("{}", std::stod(field) / 9.80665) : field;
      }
      lines[i] = row;
    }
  });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_GE(findings("accelerometer_unit"), 1);
}

TEST_F(RunReadings, NoiseDensitiesOfNearlyZeroAreRaised) {
  const double sigma = [&] {
    EXPECT_EQ(run().exit_code, 0);
    return lastSigma_m();
  }();
  for (const char* key : {"gyroscope_noise_density: 1.7e-4", "gyroscope_random_walk: 2.0e-5",
                          "accelerometer_noise_density: 2.0e-3", "accelerometer_random_walk: 3.0e-3"}) {
    const std::string line = key;
    replaceText(recording_.sensor("imu0") / "sensor.yaml", line, line.substr(0, line.find(':')) + ": 1.0e-9");
  }
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_GE(findings("imu_noise_too_small"), 3);
  EXPECT_NEAR(lastSigma_m() / sigma, 1.0, 0.5);
}

}  // namespace
}  // namespace lodeline::test

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/files/test_data.h"

// Tests of the program on a real recording (EuRoC MH_01_easy, first 14 s of images) with required accuracies,
// and on shortened or extended variants of it.

namespace lodeline::test {
namespace {

struct CsvTable {
  std::string header;
  std::vector<std::pair<int64_t, std::string>> rows;  ///< stamp in ns, rest of the line with its comma
};

CsvTable readCsv(const std::filesystem::path& file) {
  CsvTable table;
  std::ifstream stream(file);
  std::getline(stream, table.header);
  for (std::string line; std::getline(stream, line);) {
    const size_t comma = line.find(',');
    table.rows.emplace_back(std::stoll(line.substr(0, comma)), line.substr(comma));
  }
  return table;
}

void writeCsv(const std::filesystem::path& file, const CsvTable& table) {
  std::ofstream stream(file);
  stream << table.header << "\n";
  for (const auto& [stamp_ns, rest] : table.rows) stream << stamp_ns << rest << "\n";
}

class Mh01Program : public testing::Test {
 protected:
  void SetUp() override {
    const std::optional<std::filesystem::path> recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    data_ = *recording;
    truth_ = data_ / "mav0" / "state_groundtruth_estimate0" / "gt_tum.txt";
  }

  /// The recording with its own lists and links to all other files.
  std::filesystem::path makeVariant(const std::string& name) const {
    const std::filesystem::path variant = folder_.path() / name;
    for (const char* sensor : {"cam0", "cam1", "imu0"}) {
      std::filesystem::create_directories(variant / "mav0" / sensor);
      for (const char* linked : {"data", "sensor.yaml"}) {
        const auto original = data_ / "mav0" / sensor / linked;
        if (!std::filesystem::exists(original)) continue;
        std::filesystem::create_symlink(std::filesystem::absolute(original),
                                        variant / "mav0" / sensor / linked);
      }
      writeCsv(csv(variant, sensor), readCsv(csv(data_, sensor)));
    }
    return variant;
  }

  static std::filesystem::path csv(const std::filesystem::path& data, const std::string& sensor) {
    return data / "mav0" / sensor / "data.csv";
  }

  /// Removes the entries before a time after the first left image from the lists of these sensors.
  static void cutStart(const std::filesystem::path& variant, double seconds,
                       const std::vector<std::string>& sensors) {
    const int64_t first_ns = readCsv(csv(variant, "cam0")).rows.front().first;
    const int64_t begin_ns = first_ns + static_cast<int64_t>(1e9 * seconds);
    for (const std::string& sensor : sensors) {
      CsvTable table = readCsv(csv(variant, sensor));
      std::erase_if(table.rows, [&](const auto& row) { return row.first < begin_ns; });
      writeCsv(csv(variant, sensor), table);
    }
  }

  /// Rotates camera 1 about its own axes in its file.
  static void turnCamera1(const std::filesystem::path& variant, const Vec3& turn) {
    const std::filesystem::path file = variant / "mav0" / "cam1" / "sensor.yaml";
    std::string text = readText(file);
    const size_t begin = text.find('[', text.find("T_BS")) + 1;
    const size_t end = text.find(']', begin);
    std::string numbers = text.substr(begin, end - begin);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    std::istringstream stream(numbers);
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> body_from_camera;
    for (double& number : body_from_camera.reshaped<Eigen::RowMajor>()) stream >> number;
    body_from_camera.topLeftCorner<3, 3>() *= so3::exp(turn).toRotationMatrix();
    const auto rows = body_from_camera.reshaped<Eigen::RowMajor>();
    text.replace(begin, end - begin, fmt::format("{}", fmt::join(rows.begin(), rows.end(), ", ")));
    std::filesystem::remove(file);  // a link
    std::ofstream(file) << text;
  }

  std::filesystem::path run(const std::filesystem::path& data, const std::string& name,
                            const std::string& options = "") const {
    const std::filesystem::path output = folder_.path() / name;
    const Execution result =
        runProgram(fmt::format("run {} -o {} -q {}", quoted(data), quoted(output), options));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_EQ(result.output, "");
    return output;
  }

  void expectStereoFigures(const std::filesystem::path& data) const {
    const nlohmann::json figures = evaluateRun(run(data, "stereo"), truth_, imagesOf(data));
    EXPECT_EQ(figures["completion"]["percent"], 100.0);
    EXPECT_LE(figures["absolute"]["position_m"]["rmse"], 0.015);
    EXPECT_LE(figures["absolute"]["rotation_deg"]["rmse"], 1.0);
  }

  void expectMonoFigures(const std::filesystem::path& data) const {
    const nlohmann::json figures =
        evaluateRun(run(data, "mono", "--set source.cameras=[0]"), truth_, "--align sim3 " + imagesOf(data));
    EXPECT_GE(figures["completion"]["percent"], 85.0);
    EXPECT_LE(figures["absolute"]["position_m"]["rmse"], 0.015);
    EXPECT_LE(std::abs(figures["alignment"]["scale_error_percent"].get<double>()), 4.0);
  }

  static std::string imagesOf(const std::filesystem::path& data) {
    return "--images " + quoted(data / "mav0" / "cam0");
  }

  TemporaryFolder folder_;
  std::filesystem::path data_;
  std::filesystem::path truth_;
};

TEST_F(Mh01Program, StereoReachesItsFigures) { expectStereoFigures(data_); }

TEST_F(Mh01Program, LeftCameraAloneReachesItsFigures) { expectMonoFigures(data_); }

TEST_F(Mh01Program, RightCameraTurnedByADegreeInItsFile) {
  const std::filesystem::path variant = makeVariant("turned");
  turnCamera1(variant, Vec3(1.0 * kDegree, 0.0, 0.0));
  expectStereoFigures(variant);
  const nlohmann::json summary = readJson(folder_.path() / "stereo" / "run.json");
  const nlohmann::json turn = summary["camera_corrections"]["cameras"][1]["rotation_rad"];
  EXPECT_NEAR(std::hypot(turn[0].get<double>(), turn[1].get<double>(), turn[2].get<double>()), 1.0 * kDegree,
              0.1 * kDegree);
}

TEST_F(Mh01Program, ImagesOfTheFirstSecondRemoved) {
  const std::filesystem::path variant = makeVariant("first_second_removed");
  cutStart(variant, 1.0, {"cam0", "cam1"});
  expectStereoFigures(variant);
  expectMonoFigures(variant);
}

TEST_F(Mh01Program, StartedFiveSecondsLater) {
  const std::filesystem::path variant = makeVariant("started_later");
  cutStart(variant, 5.0, {"cam0", "cam1", "imu0"});
  expectStereoFigures(variant);
  expectMonoFigures(variant);
}

TEST_F(Mh01Program, TwoRunsGiveTheSameBytes) {
  const std::string options = "--set source.duration_s=6";
  const std::filesystem::path first = run(data_, "first", options);
  const std::filesystem::path second = run(data_, "second", options);
  const std::filesystem::path one_by_one = run(data_, "one_by_one", options + " --set source.prefetch=false");
  for (const char* file : {"trajectory.tum", "states.csv", "landmarks.ply"}) {
    EXPECT_FALSE(readText(first / file).empty());
    EXPECT_EQ(readText(first / file), readText(second / file)) << file;
    EXPECT_EQ(readText(first / file), readText(one_by_one / file)) << file;
  }
}

/// The recording played forwards and backwards alternately: a consistent motion of any length on real images.
/// In the backward direction, a gyroscope reads the opposite rate plus its bias; an accelerometer reads the
/// same.
class ToAndFro {
 public:
  ToAndFro(const CsvTable& clock, int passes)
      : begin_ns_(clock.rows.front().first), end_ns_(clock.rows.back().first), passes_(passes) {}

  CsvTable images(const CsvTable& original) const {
    return unroll(original, [](const std::string& rest, bool) { return rest; });
  }
  CsvTable inertial(const CsvTable& original) const { return unroll(original, reversedReading); }

 private:
  template <typename Reverse>
  CsvTable unroll(const CsvTable& original, const Reverse& reverse) const {
    CsvTable table;
    table.header = original.header;
    for (int pass = 0; pass < passes_; ++pass) {
      const bool backward = pass % 2 == 1;
      CsvTable part = original;
      std::erase_if(part.rows, [&](const auto& r) { return r.first < begin_ns_ || r.first >= end_ns_; });
      if (backward) std::reverse(part.rows.begin(), part.rows.end());
      for (const auto& [stamp_ns, rest] : part.rows) {
        const int64_t since_ns = backward ? end_ns_ - stamp_ns : stamp_ns - begin_ns_;
        table.rows.emplace_back(begin_ns_ + pass * (end_ns_ - begin_ns_) + since_ns, reverse(rest, backward));
      }
    }
    return table;
  }

  static std::string reversedReading(const std::string& rest, bool backward) {
    if (!backward) return rest;
    // From the recording's reference solution.
    constexpr double kGyroscopeBias_rad_per_s[3] = {-0.003, 0.021, 0.080};
    std::istringstream fields(rest.substr(1));
    std::string result;
    std::string field;
    for (int i = 0; std::getline(fields, field, ','); ++i) {
      result +=
          i < 3 ? fmt::format(",{}", 2.0 * kGyroscopeBias_rad_per_s[i] - std::stod(field)) : "," + field;
    }
    return result;
  }

  int64_t begin_ns_;
  int64_t end_ns_;
  int passes_;
};

TEST_F(Mh01Program, MemoryDoesNotGrowWithTime) {
  const auto peak_MB = [&](int passes) {
    const std::filesystem::path variant = makeVariant(fmt::format("passes{}", passes));
    const ToAndFro play(readCsv(csv(data_, "cam0")), passes);
    for (const char* camera : {"cam0", "cam1"}) {
      writeCsv(csv(variant, camera), play.images(readCsv(csv(data_, camera))));
    }
    writeCsv(csv(variant, "imu0"), play.inertial(readCsv(csv(data_, "imu0"))));
    // Without the page, which contains up to a hundred pictures and has its own limit.
    const std::filesystem::path output = run(variant, fmt::format("run{}", passes), "--no-report");
    const nlohmann::json summary = readJson(output / "run.json");
    EXPECT_GE(summary["frames"], 280 * passes);
    // The velocity is discontinuous where the direction changes, which counts as a contradiction.
    EXPECT_GE(summary["frames_with_pose"], 0.99 * summary["frames"].get<double>());
    EXPECT_LE(summary["frames_inertial"], 0.01 * summary["frames"].get<double>());
    return summary["peak_memory_MB"].get<double>();
  };
  // After a minute the heap has its final size. The largest windows at the start leave gaps in it, and from
  // then on it stays constant for any duration.
  const double short_MB = peak_MB(4);
  const double long_MB = peak_MB(8);
  EXPECT_LE(long_MB, 400.0);
  // Variation of the allocator; a list of all IMU readings or landmarks alone would exceed it.
  EXPECT_LE(long_MB, short_MB + 3.0);
}

}  // namespace
}  // namespace lodeline::test

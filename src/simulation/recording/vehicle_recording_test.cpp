#include "simulation/recording/vehicle_recording.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace lodeline {
namespace {

namespace fs = std::filesystem;

class VehicleRecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lodeline_vehicle_" + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Scenario tiny(const char* name, const char* realism, bool images) {
    ScenarioChanges changes;
    changes.realism = realism;
    changes.width_px = 96;
    changes.camera_rate_hz = 1.0;
    changes.seconds = 14.0;
    if (std::string(name) != "current_ramps") changes.metres = 4.0;
    changes.no_images = !images;
    return makeScenario(name, changes);
  }

  static std::map<std::string, std::string> allFiles(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::ostringstream text;
      text << file.rdbuf();
      files[fs::relative(entry.path(), folder).string()] = text.str();
    }
    return files;
  }

  /// Rows of numbers below the header.
  static std::vector<std::vector<double>> rows(const std::string& text) {
    std::vector<std::vector<double>> all;
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::vector<double> row;
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
      all.push_back(row);
    }
    return all;
  }

  fs::path folder_;
};

TEST_F(VehicleRecordingTest, SameScenarioSameBytesWithAllStreams) {
  const RecordingSummary summary = recordScenario(tiny("auv", "field", true), folder_ / "a", {});
  EXPECT_TRUE(summary.complete);
  EXPECT_GT(summary.images.total, 8u);
  ImageRecordingOptions one_thread;
  one_thread.threads = 1;
  recordScenario(tiny("auv", "field", true), folder_ / "b", one_thread);
  const auto files = allFiles(folder_ / "a");
  EXPECT_EQ(files, allFiles(folder_ / "b"));
  const std::vector<std::vector<double>> beams = rows(files.at("mav0/dvl0/data.csv"));
  EXPECT_EQ(beams.size(), 4u * 70u);
  int lost = 0;
  for (const std::vector<double>& beam : beams) {
    ASSERT_EQ(beam.size(), 5u);
    if (beam[4] == 1.0) continue;
    ++lost;
    EXPECT_EQ(beam[2], 0.0);
    EXPECT_EQ(beam[3], -2.0);
  }
  EXPECT_NEAR(lost, 28, 18);
  EXPECT_GT(rows(files.at("mav0/altimeter0/data.csv")).size(), 100u);
  const auto currents = rows(files.at("mav0/current0/data.csv"));
  EXPECT_EQ(currents.size(), 140u);
  EXPECT_EQ(currents.front().size(), 1u + currentChannels().size());
  EXPECT_TRUE(
      files.at("mav0/current0/data.csv").starts_with("#timestamp [ns],thruster_1 [A],thruster_2 [A]"));
  for (const char* name :
       {"truth/currents.csv", "truth/dvl.csv", "truth/calibration/dvl0/sensor.yaml", "mav0/dvl0/sensor.yaml",
        "mav0/altimeter0/sensor.yaml", "mav0/current0/sensor.yaml"})
    EXPECT_TRUE(files.count(name)) << name;
  // What the files of the field do not say.
  EXPECT_NE(files.at("truth/calibration/dvl0/sensor.yaml"), files.at("mav0/dvl0/sensor.yaml"));
  EXPECT_EQ(files.at("mav0/current0/sensor.yaml").find("field_T_per_A"), std::string::npos);
  EXPECT_NE(files.at("truth/calibration/current0/sensor.yaml").find("field_T_per_A"), std::string::npos);
}

TEST_F(VehicleRecordingTest, TrueStreamsAreThoseOfTheMotion) {
  recordScenario(tiny("wreck", "clean", false), folder_ / "a", {});
  const auto files = allFiles(folder_ / "a");
  const Dive dive = makeDive(tiny("wreck", "clean", false));
  const auto steel = rows(files.at("truth/steel_field.csv"));
  ASSERT_EQ(steel.size(), 141u);
  for (const std::vector<double>& row : steel) {
    const double t = row[0] * 1e-9 - static_cast<double>(dive.start.nanoseconds()) * 1e-9;
    const Vec3 field = fieldOfDipoles(
        dive.disturbances.steel, dive.motion.at(std::round(10.0 * t) / 10.0).world_from_body.translation);
    EXPECT_LT((field - Vec3(row[1], row[2], row[3])).norm(), 1e-11);
  }
  EXPECT_EQ(rows(files.at("truth/steel.csv")).size(), dive.disturbances.steel.size());
  // Velocities of the DVL give its path.
  Vec3 path = Vec3::Zero();
  const Rigid3& body_from_dvl = dive.errors.truth.rig.dvl->body_from_dvl;
  const auto velocities = rows(files.at("truth/dvl.csv"));
  for (size_t i = 0; i + 1 < velocities.size(); ++i) {
    const Quat world_from_dvl =
        dive.motion.at(0.1 * static_cast<double>(i)).world_from_body.rotation * body_from_dvl.rotation;
    path += 0.1 * (world_from_dvl * Vec3(velocities[i][1], velocities[i][2], velocities[i][3]));
  }
  const Vec3 travelled = dive.motion.at(14.0).world_from_body * body_from_dvl.translation -
                         dive.motion.at(0.0).world_from_body * body_from_dvl.translation;
  EXPECT_LT((path - travelled).norm(), 0.03);
}

TEST_F(VehicleRecordingTest, RampsOfCurrentsAreARecordingAtRest) {
  ScenarioChanges changes;
  const Scenario first = makeScenario("current_ramps", changes);
  recordScenario(first, folder_ / "a", {});
  changes.cables_moved = true;
  recordScenario(makeScenario("current_ramps", changes), folder_ / "b", {});
  const auto a = allFiles(folder_ / "a"), b = allFiles(folder_ / "b");
  EXPECT_FALSE(a.count("mav0/dvl0/data.csv"));
  EXPECT_FALSE(a.count("mav0/pressure0/data.csv"));
  EXPECT_EQ(a.at("mav0/current0/data.csv"), b.at("mav0/current0/data.csv"));
  EXPECT_NE(a.at("mav0/mag0/data.csv"), b.at("mav0/mag0/data.csv"));
  double most_A = 0.0;
  for (const auto& row : rows(a.at("mav0/current0/data.csv"))) most_A = std::max(most_A, row[1]);
  EXPECT_NEAR(most_A, 20.0, 0.2);
}

}  // namespace
}  // namespace lodeline

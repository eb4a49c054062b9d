#include "lodeline/simulation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "simulation/dive/dive.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

class RecordingTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("lodeline_recording_" + std::string(test->name()) + std::to_string(getpid()));
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// A dive of a few seconds with tiny images.
  static Scenario tiny(const char* realism, bool images = true, const char* name = "demo") {
    ScenarioChanges changes;
    changes.realism = realism;
    changes.width_px = 96;
    changes.camera_rate_hz = 2.0;
    changes.seconds = 14.0;
    changes.no_images = !images;
    if (std::string(name) != "figure_eight") changes.metres = 1.2;
    return makeScenario(name, changes);
  }

  static std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  static std::map<std::string, std::string> allFiles(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file())
        files[fs::relative(entry.path(), folder).string()] = contents(entry.path());
    }
    return files;
  }

  void expectNoTruthOutside(const Dive& dive) const;

  fs::path folder_;
};

void RecordingTest::expectNoTruthOutside(const Dive& dive) const {
  // True values as text, to search for copies of them.
  std::vector<std::string> secrets;
  const auto hide = [&](double value) { secrets.push_back(fmt::format("{}", value)); };
  for (const Rig* rig : {&dive.errors.in_water, &dive.errors.truth.rig}) {
    for (const CameraCalibration& camera : rig->cameras) {
      hide(camera.fx_px);
      hide(camera.cx_px);
      hide(camera.body_from_camera.translation.x());
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    hide(dive.errors.imu.gyroscope.turn_on_bias[axis]);
    hide(dive.errors.magnetometer.hard_iron_T[axis]);
    hide(dive.field_W[axis]);
  }
  hide(dive.errors.camera_clock.delay_s);
  hide(dive.errors.pressure.offset_m);
  for (const EffectDescription& d : effectDescriptions()) {
    if (!d.in_clean) secrets.emplace_back(d.name);
  }
  for (const char* word : {"seed", "realism", "truth", "effect"}) secrets.emplace_back(word);

  int open_files = 0;
  for (const auto& [name, text] : allFiles(folder_)) {
    if (name.starts_with("truth/") || name.starts_with("mav0/state_groundtruth_estimate0/")) continue;
    ++open_files;
    const bool known =
        name.ends_with("/data.csv") || name.ends_with("/sensor.yaml") || name.ends_with(".png");
    EXPECT_TRUE(known) << name;
    if (name.ends_with(".png")) continue;
    for (const std::string& secret : secrets)
      EXPECT_EQ(text.find(secret), std::string::npos) << name << ": " << secret;
  }
  EXPECT_GT(open_files, 40);
  // The truth folder has them.
  const std::string errors = contents(folder_ / "truth" / "errors.yaml");
  EXPECT_NE(errors.find(fmt::format("{}", dive.errors.camera_clock.delay_s)), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "truth" / "landmarks.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "truth" / "calibration" / "cam0" / "sensor.yaml"));
}

// One recording for both tests, because building a cave takes seconds.
TEST_F(RecordingTest, IsReadByTheProgramAsWrittenAndShowsNoTruthElsewhere) {
  const Scenario scenario = tiny("field");
  const RecordingSummary summary = recordScenario(scenario, folder_, {});
  EXPECT_TRUE(summary.complete);
  EXPECT_GT(summary.images.total, 40u);
  const Dive dive = makeDive(scenario);

  Diagnostics diagnostics;
  EurocSource source(folder_, {}, &diagnostics);
  const Rig& rig = source.rig();
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].fx_px, dive.errors.given.cameras[1].fx_px);
  EXPECT_LT(
      (rig.cameras[1].body_from_camera.matrix() - dive.errors.given.cameras[1].body_from_camera.matrix())
          .norm(),
      1e-12);
  EXPECT_EQ(rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz,
            dive.errors.given.imu.noise.gyroscope_density_rad_per_s_sqrtHz);
  EXPECT_TRUE(rig.magnetometer && rig.pressure && rig.sonar);
  int imu = 0, magnetometer = 0, depth = 0, sonar = 0, images = 0;
  while (source.nextImu()) ++imu;
  while (source.nextMagnetometer()) ++magnetometer;
  while (source.nextDepth()) ++depth;
  while (source.nextSonar()) ++sonar;
  for (size_t camera = 0; camera < 2; ++camera) {
    while (source.nextImage(camera)) ++images;
  }
  EXPECT_EQ(imu, 14 * 200 + 1);
  EXPECT_EQ(magnetometer, 14 * 50);
  EXPECT_EQ(depth, 28);
  EXPECT_GT(sonar, 14 * 20 / 2);
  EXPECT_EQ(static_cast<size_t>(images), summary.images.total);
  for (const Finding& finding : diagnostics.ranked()) {
    EXPECT_EQ(finding.severity, Severity::Notice) << finding.first_message;
  }
  const cv::Mat image =
      cv::imread((*fs::directory_iterator(folder_ / "mav0/cam0/data")).path().string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(image.cols, 96);
  EXPECT_EQ(image.rows, 72);
  EXPECT_EQ(image.type(), CV_8UC1);
  expectNoTruthOutside(dive);
}

TEST_F(RecordingTest, SameScenarioSameBytes) {
  recordScenario(tiny("field", true, "open_water"), folder_ / "a", {});
  ImageRecordingOptions one_thread;
  one_thread.threads = 1;
  recordScenario(tiny("field", true, "open_water"), folder_ / "b", one_thread);
  EXPECT_EQ(allFiles(folder_ / "a"), allFiles(folder_ / "b"));
}

TEST_F(RecordingTest, GoesOnWhereItWasInterrupted) {
  ImageRecordingOptions interrupted;
  interrupted.threads = 1;
  int asked = 0;
  interrupted.stop = [&] { return ++asked == 5; };
  const RecordingSummary first =
      recordScenario(tiny("clean", true, "open_water"), folder_ / "a", interrupted);
  EXPECT_FALSE(first.complete);
  EXPECT_EQ(first.images.done, 5u);
  const RecordingSummary second = recordScenario(tiny("clean", true, "open_water"), folder_ / "a", {});
  EXPECT_TRUE(second.complete);
  EXPECT_TRUE(second.resumed);
  EXPECT_EQ(second.images.rendered, second.images.total - 5);
  recordScenario(tiny("clean", true, "open_water"), folder_ / "b", {});
  EXPECT_EQ(allFiles(folder_ / "a"), allFiles(folder_ / "b"));
}

TEST_F(RecordingTest, RefusesFoldersThatHoldSomethingElse) {
  recordScenario(tiny("clean", false, "figure_eight"), folder_ / "a", {});
  EXPECT_THROW(recordScenario(tiny("field", false, "figure_eight"), folder_ / "a", {}), InputError);
  fs::create_directories(folder_ / "b");
  std::ofstream(folder_ / "b" / "notes.txt") << "mine";
  EXPECT_THROW(recordScenario(tiny("clean", false, "figure_eight"), folder_ / "b", {}), InputError);
  EXPECT_EQ(contents(folder_ / "b" / "notes.txt"), "mine");
  std::ofstream(folder_ / "c") << "a file";
  EXPECT_THROW(recordScenario(tiny("clean", false, "figure_eight"), folder_ / "c", {}), InputError);
}

TEST_F(RecordingTest, OtherNoiseChangesReadingsAndNeitherMotionNorRig) {
  const fs::path other = folder_.string() + "_other";
  Scenario scenario = tiny("field", false, "figure_eight");
  recordScenario(scenario, folder_, {});
  scenario.noise_seed = 7;
  recordOtherNoise(scenario, folder_, other);
  const auto first = allFiles(folder_);
  const auto second = allFiles(other);
  for (const char* name : {"mav0/imu0/data.csv", "mav0/mag0/data.csv", "mav0/pressure0/data.csv"}) {
    EXPECT_NE(first.at(name), second.at(name)) << name;
  }
  for (const char* name : {"mav0/imu0/sensor.yaml", "mav0/mag0/sensor.yaml"}) {
    EXPECT_EQ(first.at(name), second.at(name)) << name;
  }
  // Pose and velocity are equal to the last digit; biases are not.
  std::istringstream truth(first.at("mav0/state_groundtruth_estimate0/data.csv"));
  std::istringstream other_truth(second.at("mav0/state_groundtruth_estimate0/data.csv"));
  const auto stateOf = [](const std::string& line) {
    size_t end = 0;
    for (int column = 0; column < 11; ++column) end = line.find(',', end + 1);
    return line.substr(0, end);
  };
  int rows = 0, equal_biases = 0;
  for (std::string a, b; std::getline(truth, a) && std::getline(other_truth, b); ++rows) {
    ASSERT_EQ(stateOf(a), stateOf(b));
    equal_biases += rows > 0 && a == b ? 1 : 0;
  }
  EXPECT_EQ(rows, 1401 + 1);
  EXPECT_EQ(equal_biases, 0);

  scenario.duration_s += 1.0;
  EXPECT_THROW(recordOtherNoise(scenario, folder_, other), InputError);
  EXPECT_FALSE(holdsRecording(scenario, folder_));
  fs::remove_all(other);
}

TEST_F(RecordingTest, ImagesLeaveTheOtherSensorsAsTheyAre) {
  recordScenario(tiny("field", false, "open_water"), folder_ / "a", {});
  recordScenario(tiny("field", true, "open_water"), folder_ / "b", {});
  for (const char* name : {"imu0", "mag0", "pressure0", "sonar0", "state_groundtruth_estimate0"}) {
    const fs::path file = fs::path("mav0") / name / "data.csv";
    EXPECT_EQ(contents(folder_ / "a" / file), contents(folder_ / "b" / file)) << name;
  }
  EXPECT_FALSE(fs::exists(folder_ / "a" / "mav0" / "cam0"));
}

TEST_F(RecordingTest, GroundTruthIsTheTrueStateWithTheBiasesOfTheReadings) {
  const Scenario scenario = tiny("clean", false, "figure_eight");
  recordScenario(scenario, folder_, {});
  const Dive dive = makeDive(scenario);
  std::ifstream file(folder_ / "mav0/state_groundtruth_estimate0/data.csv");
  std::string line;
  std::getline(file, line);
  int rows = 0;
  while (std::getline(file, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream stream(line);
    int64_t stamp = 0;
    double v[16];
    stream >> stamp;
    for (double& value : v) stream >> value;
    ASSERT_TRUE(stream);
    const MotionState state = dive.motion.at((Time::fromNanoseconds(stamp) - dive.start).seconds());
    EXPECT_LT((state.world_from_body.translation - Vec3(v[0], v[1], v[2])).norm(), 1e-6);
    EXPECT_LT(so3::log(state.world_from_body.rotation.conjugate() * Quat(v[3], v[4], v[5], v[6])).norm(),
              1e-8);
    EXPECT_LT((state.velocity_W - Vec3(v[7], v[8], v[9])).norm(), 1e-6);
    EXPECT_LT((dive.errors.imu.gyroscope.turn_on_bias - Vec3(v[10], v[11], v[12])).norm(), 5e-4);
    ++rows;
  }
  EXPECT_EQ(rows, 1401);
}

}  // namespace
}  // namespace lodeline

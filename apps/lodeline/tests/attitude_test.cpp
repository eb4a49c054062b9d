#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of `lodeline attitude` as a program.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

class AttitudeTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return test::quoted(folder_.path() / name); }

  /// Magnetometer reading as a function of time in s and of the true field, T; empty for none.
  using Spoil = std::function<std::optional<Vec3>(double, const Vec3&)>;

  /// Writes ten seconds at 100 Hz, level, x axis at an azimuth of 30 degrees, in the units of its header.
  void writeLevel(const std::string& name, const Spoil& spoil) {
    std::string text = "t [s],gx [deg/s],gy [deg/s],gz [deg/s],ax [g],ay [g],az [g]";
    if (spoil) text += fmt::format(",mx [{0}],my [{0}],mz [{0}]", stated_unit_);
    text += "\n";
    for (int i = 0; i < 1000; ++i) {
      text += fmt::format("{:.2f},{},0.1,-0.1,0,0,{}", 0.01 * i, i % 2 == 0 ? 0.01 : -0.01,
                          i % 2 == 0 ? 1.001 : 0.999);
      // North, of 20 uT, is 30 degrees to the left of x.
      const Vec3 field_uT(20.0 * std::cos(M_PI / 6.0), 10.0, -40.0 - 1e-3 * (i % 7));
      const std::optional<Vec3> seen_uT = spoil ? spoil(0.01 * i, field_uT) : std::nullopt;
      if (seen_uT) text += fmt::format(",{},{},{}", seen_uT->x(), seen_uT->y(), seen_uT->z());
      if (spoil && !seen_uT) text += ",,,";
      text += "\n";
    }
    folder_.write(name, text);
  }
  void writeLevel(const std::string& name, bool with_field) {
    writeLevel(name, with_field ? Spoil([](double, const Vec3& field_uT) { return field_uT; }) : Spoil());
  }

  /// attitude.json of readings modified by `spoil`.
  nlohmann::json attitudeOf(const Spoil& spoil) {
    writeLevel("spoilt.csv", spoil);
    const Execution result = runProgram("attitude " + file("spoilt.csv") + " -o " + file("spoilt"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return test::readJson(folder_.path() / "spoilt" / "attitude.json");
  }
  static int findings(const nlohmann::json& json, const std::string& kind) {
    int count = 0;
    for (const auto& finding : json["findings"]) {
      if (finding["kind"] == kind) count += finding["count"].get<int>();
    }
    return count;
  }
  static double shareOf(const nlohmann::json& json, const std::string& status) {
    return json["status_share"].value(status, 0.0);
  }
  static double heading_deg(const nlohmann::json& json) { return json["end"]["heading_deg"]; }

  std::string stated_unit_ = "uT";
  test::TemporaryFolder folder_;
};

TEST_F(AttitudeTest, FindsHeadingFromACsvFile) {
  writeLevel("level.csv", true);
  const Execution result = runProgram("attitude " + file("level.csv") + " -o " + file("out"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("magnetic north"));
  EXPECT_THAT(result.output, HasSubstr("not calibrated"));
  const auto json = test::readJson(folder_.path() / "out" / "attitude.json");
  EXPECT_NEAR(json["end"]["heading_deg"].get<double>(), 30.0, 0.5);
  EXPECT_NEAR(json["gyroscope_bias_rad_per_s"][1].get<double>(), 0.1 * M_PI / 180.0, 1e-4);
  EXPECT_GT(json["status_share"]["magnetic"].get<double>(), 0.9);
  EXPECT_EQ(json["estimates"], 200);
  EXPECT_THAT(test::readText(folder_.path() / "out" / "attitude.csv"), HasSubstr(",magnetic,"));

  // The declination at Devil's Eye is 6.4 degrees west.
  const Execution at_site = runProgram("attitude " + file("level.csv") + " -o " + file("true") +
                                       " --site 29.83,-82.60,0 --date 2026-11-21");
  ASSERT_EQ(at_site.exit_code, 0) << at_site.output;
  EXPECT_THAT(at_site.output, HasSubstr("true north"));
}

TEST_F(AttitudeTest, GoesWithoutAMagnetometer) {
  writeLevel("level.csv", false);
  const Execution result = runProgram("attitude " + file("level.csv") + " -o " + file("out"));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no magnetometer"));
}

TEST_F(AttitudeTest, TellsTheUnitFromTheFieldsSize) {
  stated_unit_ = "T";
  for (const double per_uT : {1.0, 1e-2, 10.0, 1e3}) {  // uT, G, mG, nT
    bool first = true;
    const auto json = attitudeOf([&](double, const Vec3& field_uT) {
      // A single wrong first reading must not determine the unit.
      const Vec3 reading = first ? Vec3(5.0, 0.0, 0.0) : Vec3(per_uT * field_uT);
      first = false;
      return reading;
    });
    EXPECT_EQ(findings(json, "magnetometer_converted"), 1) << per_uT;
    EXPECT_NEAR(heading_deg(json), 30.0, 0.5) << per_uT;
  }
}

TEST_F(AttitudeTest, NamesAFieldThatRisesWhereNoSiteExplainsIt) {
  const auto good = attitudeOf([](double, const Vec3& field_uT) { return field_uT; });
  EXPECT_EQ(findings(good, "magnetometer_reversed"), 0);
  // Of an accelerometer with reversed signs, or of a magnetometer with them.
  const auto risen = attitudeOf([](double, const Vec3& field_uT) { return Vec3(-field_uT); });
  EXPECT_EQ(findings(risen, "magnetometer_reversed"), 1);
}

TEST_F(AttitudeTest, GoesOnWhereTheMagnetometerFails) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  auto json = attitudeOf(
      [&](double t, const Vec3& field_uT) { return t < 5.0 ? field_uT : Vec3(Vec3::Constant(nan)); });
  EXPECT_EQ(findings(json, "csv_field"), 500);
  EXPECT_NEAR(heading_deg(json), 30.0, 0.5);
  EXPECT_NEAR(shareOf(json, "waiting"), 0.35, 0.02);

  json =
      attitudeOf([](double t, const Vec3& field_uT) { return t < 5.0 ? field_uT : Vec3(17.0, 9.0, -41.0); });
  EXPECT_EQ(findings(json, "magnetometer_frozen"), 1);
  EXPECT_NEAR(heading_deg(json), 30.0, 0.5);
  EXPECT_NEAR(shareOf(json, "waiting"), 0.35, 0.02);

  // At the limit of its range the norm of the field changes.
  json = attitudeOf([](double t, const Vec3& field_uT) {
    return Vec3(t < 5.0 ? field_uT : field_uT.cwiseMin(15.0).cwiseMax(-15.0) + Vec3(0.0, 1e-3 * t, 0.0));
  });
  EXPECT_NEAR(heading_deg(json), 30.0, 0.5);
  EXPECT_NEAR(shareOf(json, "wrong_norm"), 0.5, 0.05);
}

TEST_F(AttitudeTest, TakesASlowMagnetometer) {
  // New readings once a second, repeated in the rows between.
  const auto json = attitudeOf([](double t, const Vec3& field_uT) {
    return Vec3(field_uT.x(), field_uT.y(), -40.0 - 1e-3 * std::floor(t + 1e-6));
  });
  EXPECT_NEAR(heading_deg(json), 30.0, 1.0);
  EXPECT_GT(shareOf(json, "magnetic"), 0.7);
  EXPECT_EQ(findings(json, "magnetometer_frozen"), 0);
}

TEST_F(AttitudeTest, ReadsRecordingsWithoutCameras) {
  ASSERT_EQ(runProgram("simulate figure_eight --seconds 30 --quiet -o " + file("eight")).exit_code, 0);
  const Execution result = runProgram("attitude " + file("eight") + " -o " + file("out") + " --rate-hz 0");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(test::readJson(folder_.path() / "out" / "attitude.json")["estimates"], 6001);
}

TEST_F(AttitudeTest, ReadsABagLikeAFolder) {
  ASSERT_EQ(runProgram("simulate figure_eight --seconds 20 --quiet -o " + file("eight")).exit_code, 0);
  const Execution converted = runProgram("convert " + file("eight") + " " + file("eight.bag"));
  if (converted.exit_code == 2) GTEST_SKIP() << converted.output;  // built without librosbag-storage
  ASSERT_EQ(converted.exit_code, 0) << converted.output;
  const Execution folder = runProgram("attitude " + file("eight") + " -o " + file("folder"));
  ASSERT_EQ(folder.exit_code, 0) << folder.output;
  const Execution bag =
      runProgram("attitude " + file("eight.bag") + " --rig " + file("eight.rig.yaml") + " -o " + file("bag"));
  ASSERT_EQ(bag.exit_code, 0) << bag.output;
  EXPECT_EQ(test::readText(folder_.path() / "bag" / "attitude.csv"),
            test::readText(folder_.path() / "folder" / "attitude.csv"));
}

TEST_F(AttitudeTest, RefusesBadInputAndUsage) {
  folder_.write("field.csv", "0.0,1e-5,1e-5,1e-5\n0.1,1e-5,1e-5,2e-5\n");
  const Execution no_imu = runProgram("attitude " + file("field.csv") + " -o " + file("out"));
  EXPECT_EQ(no_imu.exit_code, 1);
  EXPECT_THAT(no_imu.output, HasSubstr("no gyroscope"));
  writeLevel("level.csv", true);
  EXPECT_EQ(runProgram("attitude " + file("absent") + " -o " + file("out")).exit_code, 1);
  EXPECT_EQ(runProgram("attitude " + file("level.csv")).exit_code, 2);
  EXPECT_EQ(runProgram("attitude " + file("level.csv") + " -o " + file("out") + " --site 1,2,3").exit_code,
            2);
  EXPECT_EQ(runProgram("attitude " + file("level.csv") + " -o " + file("out") + " --magnetometer-lag-s 3")
                .exit_code,
            2);
}

}  // namespace
}  // namespace lodeline

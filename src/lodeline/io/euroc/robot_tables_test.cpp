#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/current_table.h"
#include "lodeline/io/euroc/dvl_table.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/robots/dvl_text.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RobotTablesTest : public testing::Test {
 protected:
  std::vector<DvlSample> pings(const std::string& text, size_t beams = 4) {
    place_.write("dvl0/data.csv", text);
    DvlTable table(place_.path("dvl0/data.csv"), beams, &diagnostics_);
    std::vector<DvlSample> result;
    while (const std::optional<DvlSample> ping = table.next()) result.push_back(*ping);
    return result;
  }
  std::vector<CurrentSample> currents(const std::string& text, const std::vector<std::string>& channels) {
    place_.write("current0/data.csv", text);
    CurrentTable table(place_.path("current0/data.csv"), channels, &diagnostics_);
    channels_ = table.channels();
    std::vector<CurrentSample> result;
    while (const std::optional<CurrentSample> sample = table.next()) result.push_back(*sample);
    return result;
  }
  template <typename Work>
  std::string refusal(const Work& work) {
    try {
      work();
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  std::string message(const std::string& kind) const {
    for (const Finding& finding : diagnostics_.ranked()) {
      if (finding.kind == kind) return finding.first_message;
    }
    return {};
  }

  TestRecording place_;
  Diagnostics diagnostics_;
  std::vector<std::string> channels_;
};

TEST_F(RobotTablesTest, RemovesEverySentinelOfAVelocity) {
  const std::vector<DvlSample> read = pings(
      "#timestamp [ns],v_x,v_y,v_z [m/s],valid\n"
      "1000000000,0.1,-0.2,0.3,1\n"
      "1200000000,0.0,0.0,0.0,0\n"
      "1400000000,0.0,0.0,0.0,1\n"  // at rest
      "1600000000,-32.768,-32.768,-32.768,1\n"
      "1800000000,nan,0.1,0.1,1\n"
      "2000000000,,,,0\n"
      "2200000000,0.4,0.5,0.6,0\n"
      "2400000000,0.1,0.1,-32.768,1\n"
      "2600000000,-2,0.1,0.1,1\n");
  ASSERT_EQ(read.size(), 9u);
  EXPECT_EQ(read[0].velocity_D, Vec3(0.1, -0.2, 0.3));
  EXPECT_EQ(read[2].velocity_D, Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(read[8].velocity_D, Vec3(-2.0, 0.1, 0.1)) << "a velocity of -2 m/s along one axis is possible";
  for (const size_t i : {1, 3, 4, 5, 6, 7}) EXPECT_FALSE(read[i].velocity_D) << i;
  EXPECT_EQ(diagnostics_.count("dvl_no_lock"), 1);
  EXPECT_THAT(message("dvl_no_lock"), HasSubstr("6 of 9 pings (66.7 %)"));
  EXPECT_EQ(diagnostics_.count("csv_row"), 0);
}

TEST_F(RobotTablesTest, DoubtsZerosWithoutAStatedValidity) {
  const std::vector<DvlSample> read =
      pings("time [s],vx [mm/s],vy [mm/s],vz [mm/s]\n1.0,0,0,0\n1.2,100,0,0\n1.4,-2000,-2000,-2000\n");
  ASSERT_EQ(read.size(), 3u);
  EXPECT_FALSE(read[0].velocity_D);
  EXPECT_LT((*read[1].velocity_D - Vec3(0.1, 0.0, 0.0)).norm(), 1e-15);
  EXPECT_FALSE(read[2].velocity_D);
  EXPECT_EQ(read[1].time.nanoseconds(), 1'200'000'000);
}

TEST_F(RobotTablesTest, UnitesTheBeamsOfAPing) {
  std::string text = "#timestamp [ns],beam,velocity [cm/s],range [m],valid\n";
  for (int ping = 0; ping < 3; ++ping) {
    for (int beam = 0; beam < 4; ++beam) {
      const bool is_lost = ping == 1 && beam == 2;
      text += fmt::format("{},{},{},{},{:d}\n", 1'000'000'000 + ping * 200'000'000LL, beam,
                          is_lost ? 0 : 10 * (beam + 1), is_lost ? -2.0 : 2.5, !is_lost);
    }
  }
  const std::vector<DvlSample> read = pings(text);
  ASSERT_EQ(read.size(), 3u);
  for (const DvlSample& ping : read) {
    ASSERT_EQ(ping.beams.size(), 4u);
    EXPECT_FALSE(ping.velocity_D);
    EXPECT_EQ(ping.beams[3].index, 3);
    EXPECT_DOUBLE_EQ(*ping.beams[3].velocity_m_per_s, 0.4);
  }
  EXPECT_FALSE(read[1].beams[2].velocity_m_per_s);
  EXPECT_FALSE(read[1].beams[2].range_m);
  EXPECT_EQ(read[0].beams[2].range_m, 2.5);
  EXPECT_THAT(message("dvl_no_lock"),
              HasSubstr("0 of 3 pings (0.0 %) have no lock; 1 (33.3 %) lack some beams"));
}

TEST_F(RobotTablesTest, CountsBeamsFromOneWhereAllDo) {
  std::string from_one = "#timestamp [ns],beam,velocity [m/s],range [m],valid,track\n", mixed = from_one;
  for (int beam = 1; beam <= 4; ++beam) {
    from_one += fmt::format("1000000000,{},0.{},2,1,water\n", beam, beam);
    mixed += fmt::format("1000000000,{},0.{},2,1,water\n", beam + 1, beam);
  }
  const std::vector<DvlSample> read = pings(from_one);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].beams[0].index, 0);
  EXPECT_EQ(read[0].beams[3].index, 3);
  EXPECT_EQ(read[0].track, DvlTrack::Water);
  EXPECT_EQ(diagnostics_.count("dvl_beam_numbers"), 1);
  EXPECT_EQ(pings(mixed)[0].beams.size(), 3u) << "beam 5 of 4 is left out";
  EXPECT_GT(diagnostics_.count("dvl_beam_unknown"), 0);
}

TEST_F(RobotTablesTest, TakesABeamThatComesAgainAsAnotherPing) {
  const std::vector<DvlSample> read = pings(
      "#timestamp [ns],beam,velocity [m/s],range [m],valid\n"
      "1000000000,0,0.1,2,1\n1000000000,1,0.2,2,1\n1000000000,0,0.1,2,1\n");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].beams.size(), 2u);
  EXPECT_EQ(read[1].beams.size(), 1u);
}

TEST_F(RobotTablesTest, RefusesATableOfADvlThatIsNotClear) {
  EXPECT_THAT(refusal([&] { pings("1000000000,0.1,0.2,0.3,1\n"); }), HasSubstr("no header"));
  EXPECT_THAT(refusal([&] { pings("#timestamp [ns],v_x,v_y,valid\n1,1,1,1\n"); }),
              HasSubstr("2 of the three"));
  EXPECT_THAT(refusal([&] { pings("#timestamp [ns],v_x [m/s],v_y [m/s],v_z [furlong],valid\n1,1,1,1,1\n"); }),
              HasSubstr("'furlong' of the velocity"));
  EXPECT_THAT(refusal([&] { pings("#timestamp [ns],beam,range [m],valid\n1,1,1,1\n"); }),
              HasSubstr("names no velocity"));
}

TEST_F(RobotTablesTest, DoubtsAVelocityThatNoVehicleHas) {
  pings("#timestamp [ns],v_x,v_y,v_z [m/s],valid\n1000000000,250,10,3,1\n1200000000,260,10,3,1\n");
  EXPECT_EQ(diagnostics_.count("dvl_unit"), 1);
}

TEST_F(RobotTablesTest, ReadsWhatItWritesOfADvl) {
  std::vector<DvlSample> written(4);
  for (size_t i = 0; i < written.size(); ++i)
    written[i].time = Time::fromNanoseconds(1'000'000'000 + 200'000'000 * i);
  written[0].velocity_D = Vec3(0.1, 0.2, 1.0 / 3.0);
  written[0].velocity_sigma_m_per_s = 0.007;
  written[0].beams = {{0, 0.1, 2.0}, {1, std::nullopt, 3.5}, {2, -0.25, std::nullopt}, {3, 0.125, 1.0 / 7.0}};
  written[1].track = DvlTrack::Water;
  written[1].beams = {{0, std::nullopt, std::nullopt}, {3, 0.5, 0.5}};
  written[3].velocity_D = Vec3(1.0, 0.0, -1.0);
  const auto check = [&](const std::vector<DvlSample>& expected) {
    const DvlText text(expected);
    std::string table = text.header();
    for (const DvlSample& ping : expected) table += text.rows(ping);
    const std::vector<DvlSample> read = pings(table);
    ASSERT_EQ(read.size(), expected.size()) << table;
    for (size_t i = 0; i < read.size(); ++i) {
      EXPECT_EQ(read[i].time, expected[i].time);
      EXPECT_EQ(read[i].track, expected[i].track);
      EXPECT_EQ(read[i].velocity_D, expected[i].velocity_D) << i << "\n" << table;
      EXPECT_EQ(read[i].velocity_sigma_m_per_s, expected[i].velocity_sigma_m_per_s);
      ASSERT_EQ(read[i].beams.size(), expected[i].beams.size()) << i << "\n" << table;
      for (size_t b = 0; b < read[i].beams.size(); ++b) {
        EXPECT_EQ(read[i].beams[b].index, expected[i].beams[b].index);
        EXPECT_EQ(read[i].beams[b].velocity_m_per_s, expected[i].beams[b].velocity_m_per_s);
        EXPECT_EQ(read[i].beams[b].range_m, expected[i].beams[b].range_m);
      }
    }
  };
  check(written);
  check({written[3]});
  for (DvlSample& ping : written) ping.beams.clear();
  check(written);
}

TEST_F(RobotTablesTest, OrdersChannelsByTheirNames) {
  const std::string table = "#timestamp [ns],lamp [mA],thruster 1 [A],battery\n1000000000,500,2.5,7\n";
  const std::vector<CurrentSample> ordered = currents(table, {"thruster 1", "battery", "lamp"});
  ASSERT_EQ(ordered.size(), 1u);
  EXPECT_THAT(ordered[0].currents_A, ElementsAre(2.5, 7.0, 0.5));
  EXPECT_THAT(currents(table, {})[0].currents_A, ElementsAre(0.5, 2.5, 7.0));
  EXPECT_THAT(channels_, ElementsAre("lamp", "thruster 1", "battery"));
}

TEST_F(RobotTablesTest, RefusesOtherChannelsThanThoseOfTheCalibration) {
  const std::string table = "#timestamp [ns],lamp [A],thruster_1 [A]\n1000000000,5,2.5\n";
  const std::string missing = refusal([&] { currents(table, {"lamp", "thruster_1", "thruster_2"}); });
  EXPECT_THAT(missing, HasSubstr("missing: thruster_2"));
  EXPECT_THAT(refusal([&] { currents(table, {"lamp"}); }), HasSubstr("unknown: thruster_1"));
  EXPECT_THAT(refusal([&] {
                currents(table, {"Lamp", "thruster_1"});
              }),
              HasSubstr("missing: Lamp; unknown: lamp"));
  EXPECT_THAT(refusal([&] { currents("#timestamp [ns],a [A],a [A]\n1,1,1\n", {}); }),
              HasSubstr("two channels"));
  EXPECT_THAT(refusal([&] { currents("#timestamp [ns],battery [V]\n1,1\n", {}); }),
              HasSubstr("'V' of the electric current"));
  EXPECT_THAT(refusal([&] { currents("1000000000,5,2.5\n", {}); }), HasSubstr("no header"));
}

TEST_F(RobotTablesTest, PassesOverARowWithoutACurrent) {
  const std::vector<CurrentSample> read = currents(
      "#timestamp [ns],a [A],b [A]\n1000000000,1,2\n1100000000,,2\n1200000000,nan,2\n1300000000,3,4\n", {});
  EXPECT_EQ(read.size(), 2u);
  EXPECT_EQ(diagnostics_.count("csv_row"), 2);
}

constexpr const char* kPose = "T_BS: [1,0,0,0.1, 0,-1,0,0, 0,0,-1,0.2, 0,0,0,1]\n";

TEST_F(RobotTablesTest, AFolderHasTheThreeStreams) {
  std::string altimeter = "#timestamp [ns],range [cm]\n",
              dvl = "#timestamp [ns],beam,velocity [m/s],range [m],valid\n";
  std::string current = "#timestamp [ns],thruster [A],lamp [A]\n";
  for (int i = 0; i < 10; ++i) {
    const std::string stamp = testStamp(1.0 + 0.2 * i);
    altimeter += stamp + (i == 4 ? ",-1\n" : ",350\n");
    for (int beam = 0; beam < 4; ++beam) dvl += fmt::format("{},{},0.1,2.0,1\n", stamp, beam);
    current += fmt::format("{},{},1.5\n", stamp, i);
  }
  place_.write("altimeter0/data.csv", altimeter);
  place_.write("altimeter0/sensor.yaml", std::string(kPose) + "range_noise_std: 0.02\nmax_range: 30\n");
  place_.write("dvl0/data.csv", dvl);
  place_.write("dvl0/sensor.yaml", std::string(kPose) + "velocity_noise_std: 0.012\ntimeshift: -0.05\n");
  place_.write("current0/data.csv", current);
  place_.write("current0/sensor.yaml", "channels: [lamp, thruster]\nrate_hz: 5\n");
  EurocSource source(place_.folder(), {}, &diagnostics_);
  const Rig& rig = source.rig();
  ASSERT_TRUE(rig.altimeter && rig.dvl && rig.currents);
  EXPECT_EQ(rig.altimeter->max_range_m, 30.0);
  EXPECT_EQ(rig.dvl->velocity_noise_std_m_per_s, 0.012);
  EXPECT_EQ(rig.dvl->body_from_dvl.translation, Vec3(0.1, 0.0, 0.2));
  EXPECT_NEAR(rig.dvl->rate_hz, 5.0, 0.01) << "of the pings, not of the rows";
  EXPECT_THAT(rig.currents->channels, ElementsAre("lamp", "thruster"));
  int echoes = 0, pings = 0;
  while (const std::optional<AltimeterSample> echo = source.nextAltimeter()) {
    EXPECT_DOUBLE_EQ(echo->range_m, 3.5);
    ++echoes;
  }
  EXPECT_EQ(echoes, 9);
  EXPECT_EQ(diagnostics_.count("altimeter_no_echo"), 1);
  while (const std::optional<DvlSample> ping = source.nextDvl()) {
    EXPECT_EQ(ping->beams.size(), 4u);
    ++pings;
  }
  EXPECT_EQ(pings, 10);
  source.nextCurrents();
  EXPECT_THAT(source.nextCurrents()->currents_A, ElementsAre(1.5, 1.0));
  EXPECT_THAT(diagnostics_.count("rate"), 0);
}

TEST_F(RobotTablesTest, AFolderWithOtherChannelsIsRefused) {
  place_.write("current0/data.csv", "#timestamp [ns],thruster [A]\n" + testStamp(1.0) + ",1\n");
  place_.write("current0/sensor.yaml", "channels: [lamp]\n");
  EXPECT_THAT(refusal([&] { EurocSource(place_.folder(), {}, &diagnostics_); }),
              HasSubstr("missing: lamp; unknown: thruster"));
}

}  // namespace
}  // namespace lodeline

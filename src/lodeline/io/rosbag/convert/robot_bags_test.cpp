#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/io/rosbag/definitions/message_fields.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

// Altimeter, DVL and currents in bags: conversions in all directions, and messages of the drivers.

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kDownwards = "T_BS: [1,0,0,0.1, 0,-1,0,0, 0,0,-1,0.2, 0,0,0,1]\n";
constexpr const char* kImuSection =
    "imu0: {gyroscope_noise_density: 1e-4, gyroscope_random_walk: 1e-5, accelerometer_noise_density: 1e-3, "
    "accelerometer_random_walk: 1e-4}\n";
constexpr const char* kDvlSection =
    "dvl0: {T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], velocity_noise_std: 0.01}\n";

Time stepTime(int64_t step) { return Time::fromNanoseconds(1'000'000'000'000 + step * 200'000'000); }

/// Everything that a source gives of the three streams, as text.
std::string streamsOf(MeasurementSource* source) {
  std::string text;
  while (const std::optional<AltimeterSample> echo = source->nextAltimeter())
    text += fmt::format("altimeter {} {}\n", echo->time.nanoseconds(), echo->range_m);
  while (const std::optional<DvlSample> ping = source->nextDvl()) {
    const Vec3 v = ping->velocity_D.value_or(Vec3::Constant(kNan));
    text +=
        fmt::format("dvl {} {} {} {} {} {:.6f}\n", ping->time.nanoseconds(), static_cast<int>(ping->track),
                    v.x(), v.y(), v.z(), ping->velocity_sigma_m_per_s.value_or(kNan));
    for (const DvlBeam& beam : ping->beams)
      text += fmt::format("beam {} {} {}\n", beam.index, beam.velocity_m_per_s.value_or(kNan),
                          beam.range_m.value_or(kNan));
  }
  const std::optional<CurrentCalibration>& currents = source->rig().currents;
  text += fmt::format("channels {}\n", fmt::join(currents.value_or(CurrentCalibration()).channels, " "));
  while (const std::optional<CurrentSample> sample = source->nextCurrents())
    text += fmt::format("currents {} {}\n", sample->time.nanoseconds(), fmt::join(sample->currents_A, " "));
  return text;
}

class RobotBagsTest : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return place_.folder() / name; }

  /// A folder whose numbers have 32 bits, so that no conversion rounds them.
  void writeStreams() {
    std::string altimeter = "#timestamp [ns],range [m]\n",
                current = "#timestamp [ns],thruster 1 [A],lamp [A]\n";
    std::string dvl =
        "#timestamp [ns],beam,velocity [m/s],range [m],valid,v_x [m/s],v_y [m/s],v_z [m/s],v_valid,sigma "
        "[m/s],track\n";
    for (int i = 0; i < 12; ++i) {
      const std::string stamp = testStamp(1.0 + 0.1 * i);
      altimeter += fmt::format("{},{}\n", stamp, 2.5 + 0.125 * i);
      current += fmt::format("{},{},{}\n", stamp, 0.1 * i, 1.0 / 3.0);
      const std::string track = i % 4 == 3 ? "water" : "bottom";
      for (int beam = 0; beam < 4; ++beam) {
        const bool is_lost = i % 5 == 4 && beam < i % 3 + 1;
        dvl += fmt::format("{},{},{},{},{:d},0.1,-0.2,{},{:d},0.008,{}\n", stamp, beam,
                           is_lost ? 0.0 : 0.25 * beam - 0.125, is_lost ? -1.0 : 2.0 + 1.0 / 3.0, !is_lost,
                           1.0 / 7.0, i % 5 != 4, track);
      }
    }
    place_.write("altimeter0/data.csv", altimeter);
    place_.write("altimeter0/sensor.yaml", std::string(kDownwards) + "range_noise_std: 0.02\n");
    place_.write("dvl0/data.csv", dvl);
    place_.write("dvl0/sensor.yaml", std::string(kDownwards) +
                                         "velocity_noise_std: 0.012\n"
                                         "beams: {angle_deg: 25, azimuths_deg: [0, 90, 180, 270]}\n");
    place_.write("current0/data.csv", current);
    place_.write("current0/sensor.yaml", "channels: {lamp: {}, thruster 1: {}}\n");
  }

  std::string streamsOfFolder(const std::filesystem::path& folder) {
    EurocSource source(folder, {}, &diagnostics_);
    return streamsOf(&source);
  }
  std::string streamsOfBag(const std::filesystem::path& bag) {
    BagSource source(bag, {}, &diagnostics_);
    return streamsOf(&source);
  }

  /// A bag with an IMU and messages on `/sensor`.
  std::filesystem::path bagWith(const messages::Type& type, const std::vector<wire::Bytes>& contents) {
    const std::unique_ptr<BagWriter> writer = makeBagWriter(path("driver.mcap"), BagFormat::Mcap, "none");
    for (int i = 0; i < 100; ++i) {
      const ImuSample imu{stepTime(0) + Duration::fromSeconds(0.005 * i), {0.1, 0.2, 0.3}, {0.0, 0.0, 9.8}};
      writer->write("/imu", messages::kImu.name, imu.time, messages::imu(imu, 0));
    }
    for (size_t i = 0; i < contents.size(); ++i)
      writer->write("/sensor", type.name, stepTime(static_cast<int64_t>(i)), contents[i]);
    writer->close();
    return path("driver.mcap");
  }
  BagSource open(const std::filesystem::path& bag, const std::string& rig,
                 std::map<std::string, std::string> topics = {}) {
    place_.write("rig.yaml", kImuSection + rig);
    BagOptions options;
    options.rig_files = {place_.path("rig.yaml")};
    options.with_cameras = false;
    options.topics = std::move(topics);
    return BagSource(bag, options, &diagnostics_);
  }
  std::vector<DvlSample> pings(BagSource source) {
    std::vector<DvlSample> result;
    while (const std::optional<DvlSample> ping = source.nextDvl()) result.push_back(*ping);
    return result;
  }

  TestRecording place_;
  Diagnostics diagnostics_;
};

TEST_F(RobotBagsTest, StreamsStayTheSameInAllFormats) {
  writeStreams();
  const std::string given = streamsOfFolder(place_.folder());
  EXPECT_THAT(given, HasSubstr("channels lamp thruster 1"));
  std::vector<std::pair<std::string, BagFormat>> formats = {{"m.mcap", BagFormat::Mcap},
                                                            {"d.db3", BagFormat::Database}};
  try {
    makeBagWriter(path("probe.bag"), BagFormat::Ros1, "")->close();
    formats.emplace_back("r.bag", BagFormat::Ros1);
  } catch (const UsageError&) {  // built without librosbag-storage
  }
  for (const auto& [name, format] : formats) {
    ConvertOptions options;
    options.format = format;
    const ConvertSummary summary = convertFolderToBag(place_.folder(), path(name), options, &diagnostics_);
    EXPECT_EQ(summary.readings.at("dvl0"), 12) << name;
    EXPECT_EQ(streamsOfBag(path(name)), given) << name;
    convertBagToFolder(path(name), path(name + "_folder"), {}, &diagnostics_);
    EXPECT_EQ(streamsOfFolder(path(name + "_folder")), given) << name;
    for (const auto& [other, other_format] : formats) {
      if (other == name) continue;
      options.format = other_format;
      const auto target = path(name.substr(0, 1) + "_to_" + other);
      convertBagToBag(path(name), target, options, &diagnostics_);
      EXPECT_EQ(streamsOfBag(target), given) << target;
    }
  }
  EXPECT_EQ(diagnostics_.count("convert_rounded"), 0);
  EXPECT_EQ(diagnostics_.count("convert_left_out"), 0);
  EXPECT_EQ(diagnostics_.count("dvl_beams"), 0);
}

TEST_F(RobotBagsTest, ReportsWhatAMessageDoesNotHold) {
  writeStreams();
  place_.write(
      "dvl0/data.csv",
      fmt::format("#timestamp [ns],beam,velocity [m/s],range [m],valid\n{0},0,0.1,2,1\n{0},4,0.5,2,1\n",
                  testStamp(1.0)));
  place_.write("dvl0/sensor.yaml", std::string(kDownwards) +
                                       "velocity_noise_std: 0.012\nbeams: {angle_deg: 25, "
                                       "azimuths_deg: [0, 72, 144, 216, 288]}\n");
  ConvertOptions options;
  options.format = BagFormat::Mcap;
  convertFolderToBag(place_.folder(), path("a.mcap"), options, &diagnostics_);
  EXPECT_EQ(diagnostics_.count("convert_left_out"), 1) << "the fifth beam";
  EXPECT_EQ(diagnostics_.count("convert_rounded"), 0) << "0.1 as decimal is the same number";
}

/// A message of Water Linked's driver. `is_second`: that of ROS 2.
wire::Bytes a50(Time time, const Vec3& v, bool is_valid, int first_id, bool is_second) {
  wire::Writer writer;
  messages::putHeader(time, 0, "dvl", &writer);
  writer.put(100.0);
  messages::putVector(v, &writer);
  writer.put(0.004);
  if (is_second) writer.put(uint32_t{0});
  writer.put(is_valid ? 2.5 : -1.0);
  writer.put(uint32_t{4});
  for (int beam = 0; beam < 4; ++beam) {
    const bool has_beam = is_valid || beam == 1;
    writer.put(static_cast<int64_t>(beam + first_id));
    for (const double number : {has_beam ? 0.1 * (beam + 1) : 0.0, has_beam ? 2.7 : -1.0, -40.0, -90.0})
      writer.put(number);
    writer.put(static_cast<uint8_t>(has_beam));
  }
  writer.put(static_cast<uint8_t>(is_valid));
  writer.put(int64_t{0});
  if (is_second) writer.put(int64_t{1});
  if (is_second) writer.put(int64_t{2});
  writer.putText("json_v3.1");
  return writer.take();
}

TEST_F(RobotBagsTest, ReadsWaterLinkedsMessages) {
  for (const bool is_second : {false, true}) {
    std::vector<wire::Bytes> contents;
    for (int i = 0; i < 4; ++i)
      contents.push_back(
          a50(stepTime(i), i == 2 ? Vec3(0, 0, 0) : Vec3(0.5, 0.25, -0.125), i != 2, is_second, is_second));
    const auto bag = bagWith(is_second ? messages::kA50Dvl2 : messages::kA50Dvl, contents);
    const std::vector<DvlSample> read = pings(open(bag, kDvlSection));
    ASSERT_EQ(read.size(), 4u);
    EXPECT_EQ(read[0].time, stepTime(0));
    EXPECT_EQ(read[0].velocity_D, Vec3(0.5, 0.25, -0.125));
    EXPECT_EQ(read[0].velocity_sigma_m_per_s, 0.004);
    ASSERT_EQ(read[0].beams.size(), 4u);
    EXPECT_EQ(read[0].beams[3].index, 3);
    EXPECT_EQ(read[0].beams[3].velocity_m_per_s, 0.4);
    EXPECT_EQ(read[0].beams[3].range_m, 2.7);
    EXPECT_FALSE(read[2].velocity_D);
    EXPECT_EQ(read[2].beams[1].velocity_m_per_s, 0.2);
    EXPECT_FALSE(read[2].beams[0].range_m);
  }
  EXPECT_GT(diagnostics_.count("dvl_no_lock"), 0);
}

/// Another version of a definition: with a field more, one less, and others in another order.
TEST_F(RobotBagsTest, ReadsOtherVersionsByTheirDefinition) {
  const std::string definition =
      "std_msgs/Header header\nbool velocity_valid\nfloat32 temperature\ngeometry_msgs/Vector3 velocity\n"
      "float64 fom\n" +
      std::string(80, '=') + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
  const std::unique_ptr<BagWriter> writer = makeBagWriter(path("other.mcap"), BagFormat::Mcap, "none");
  const ImuSample imu{stepTime(0), {0.1, 0.2, 0.3}, {0.0, 0.0, 9.8}};
  writer->write("/imu", messages::kImu.name, stepTime(0), messages::imu(imu, 0));
  BagConnection connection;
  connection.topic = "/dvl";
  connection.type = "dvl_msgs/DVL";
  connection.definition = definition;
  connection.serialization = definitions::Serialization::Cdr;
  // CDR: encapsulation; seconds, nanoseconds, "d"; bool, padding, float; padding to 8; vector; figure of
  // merit.
  wire::Writer cdr;
  cdr.put(uint32_t{0x00000100});
  cdr.put(int32_t{1000});
  cdr.put(uint32_t{0});
  cdr.put(uint32_t{2});
  cdr.put(uint16_t{'d'});
  cdr.put(uint8_t{1});
  cdr.put(uint8_t{0});
  cdr.put(8.5F);
  cdr.put(uint32_t{0});
  cdr.put(0.0F);
  wire::Bytes message = cdr.take();
  message.resize(4 + 24);
  wire::Writer rest;
  for (const double number : {0.5, 0.25, -0.125, 0.01}) rest.put(number);
  const wire::Bytes numbers = rest.take();
  message.insert(message.end(), numbers.begin(), numbers.end());
  writer->writeStored(connection, stepTime(0), message);
  writer->close();
  const std::vector<DvlSample> read = pings(open(path("other.mcap"), kDvlSection));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].velocity_D, Vec3(0.5, 0.25, -0.125));
  EXPECT_EQ(read[0].velocity_sigma_m_per_s, 0.01);
  EXPECT_TRUE(read[0].beams.empty());
}

TEST_F(RobotBagsTest, RefusesMessagesThatTheBuiltInDefinitionDoesNotFit) {
  const definitions::MessageConversion conversion(
      definitions::knownForm("dvl_msgs/DVL", definitions::Serialization::Cdr),
      definitions::knownForm("dvl_msgs/DVL", definitions::Serialization::Ros1));
  const definitions::MessageConversion back(
      definitions::knownForm("dvl_msgs/DVL", definitions::Serialization::Ros1),
      definitions::knownForm("dvl_msgs/DVL", definitions::Serialization::Cdr));
  wire::Bytes cdr = back.convert(a50(stepTime(0), Vec3(1, 2, 3), true, 0, true));
  EXPECT_NO_THROW(conversion.convert(cdr));
  cdr.resize(cdr.size() + 16);
  EXPECT_THROW(conversion.convert(cdr), definitions::DefinitionError);
}

TEST_F(RobotBagsTest, TakesATwistOnlyWhereItIsNamed) {
  std::vector<wire::Bytes> contents;
  for (int i = 0; i < 3; ++i) {
    wire::Writer writer;
    messages::putHeader(stepTime(i), 0, "dvl", &writer);
    messages::putVector(i == 1 ? Vec3(0, 0, 0) : Vec3(0.5, 0.25, -0.125), &writer);
    messages::putVector(Vec3(0, 0, 0), &writer);
    contents.push_back(writer.take());
  }
  const auto bag = bagWith(messages::kTwist, contents);
  EXPECT_FALSE(open(bag, kDvlSection).rig().dvl) << "a Twist has many meanings";
  const std::vector<DvlSample> read = pings(open(bag, kDvlSection, {{"dvl0", "/sensor"}}));
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].velocity_D, Vec3(0.5, 0.25, -0.125));
  EXPECT_FALSE(read[1].velocity_D) << "zeros without a validity";
}

TEST_F(RobotBagsTest, ReportsOtherBeamsThanThoseOfTheRig) {
  DvlSample sample;
  sample.time = stepTime(0);
  sample.beams = {{0, 0.1, 2.0}};
  const auto bag =
      bagWith(messages::kMarineDvl, {messages::marineDvl(sample, DvlCalibration::janusBeams_D(0.5), 0)});
  EXPECT_EQ(pings(open(bag, kDvlSection)).size(), 1u);
  EXPECT_EQ(diagnostics_.count("dvl_beams"), 1);
}

TEST_F(RobotBagsTest, ReadsTheMessageOfTheUuvSimulator) {
  wire::Writer writer;
  messages::putHeader(stepTime(0), 0, "dvl", &writer);
  messages::putVector(Vec3(0.5, 0.25, -0.125), &writer);
  for (int i = 0; i < 9; ++i) writer.put(i % 4 == 0 ? 1e-4 : 0.0);
  writer.put(2.0);
  writer.put(uint32_t{4});
  for (int beam = 0; beam < 4; ++beam) {
    for (const double number : {2.5, beam == 1 ? -1.0 : 0.0, 0.1 * (beam + 1), beam == 2 ? -1.0 : 1e-4})
      writer.put(number);
    messages::putHeader(stepTime(0), 0, "beam", &writer);
    for (int i = 0; i < 7; ++i) writer.put(0.0);
  }
  const std::vector<DvlSample> read =
      pings(open(bagWith(messages::kSimulatedDvl, {writer.take()}), kDvlSection));
  ASSERT_EQ(read.size(), 1u);
  ASSERT_EQ(read[0].velocity_D, Vec3(0.5, 0.25, -0.125));
  EXPECT_DOUBLE_EQ(*read[0].velocity_sigma_m_per_s, 0.01);
  EXPECT_FALSE(read[0].beams[1].range_m);
  EXPECT_TRUE(read[0].beams[1].velocity_m_per_s);
  EXPECT_FALSE(read[0].beams[2].velocity_m_per_s);
}

wire::Bytes battery(Time time, float current, const std::string& location) {
  wire::Writer writer;
  messages::putHeader(time, 0, "battery", &writer);
  for (const float number : {16.0F, 20.0F, current, 1.0F, 2.0F, 3.0F, 0.5F}) writer.put(number);
  writer.put(uint32_t{0});
  writer.put(uint32_t{1});
  writer.put(3.9F);
  writer.put(uint32_t{0});
  writer.putText(location);
  writer.putText("serial");
  return writer.take();
}

TEST_F(RobotBagsTest, ReadsTheCurrentOfABattery) {
  const auto named = bagWith(messages::kBatteryState,
                             {battery(stepTime(0), -7.5F, "main"), battery(stepTime(1), -8.5F, "main")});
  BagSource source = open(named, "current0: {channels: [main]}\n");
  EXPECT_THAT(source.nextCurrents()->currents_A, ElementsAre(-7.5));
  EXPECT_THROW(open(named, "current0: {channels: [lamp]}\n"), InputError);
  const auto unnamed = bagWith(messages::kBatteryState, {battery(stepTime(0), -7.5F, "")});
  BagSource single = open(unnamed, "current0: {channels: [all]}\n");
  EXPECT_THAT(single.nextCurrents()->currents_A, ElementsAre(-7.5));
  EXPECT_THROW(open(unnamed, "current0: {channels: [lamp, all]}\n"), InputError);
}

TEST_F(RobotBagsTest, PassesOverMessagesWithOtherChannels) {
  const std::vector<std::string> names = {"lamp", "thruster"};
  const auto bag = bagWith(messages::kJointState,
                           {messages::jointCurrents({stepTime(0), {1.0, 2.0}}, names, 0),
                            messages::jointCurrents({stepTime(1), {1.0, 2.0}}, {"lamp", "other"}, 0),
                            messages::jointCurrents({stepTime(2), {4.0, 3.0}}, {"thruster", "lamp"}, 0),
                            messages::jointCurrents({stepTime(3), {1.0}}, names, 0),
                            messages::jointCurrents({stepTime(4), {kNan, 1.0}}, names, 0)});
  BagSource source = open(bag, "current0: {channels: [lamp, thruster]}\n", {{"current0", "/sensor"}});
  EXPECT_THAT(source.nextCurrents()->currents_A, ElementsAre(1.0, 2.0));
  EXPECT_THAT(source.nextCurrents()->currents_A, ElementsAre(3.0, 4.0)) << "in the order of the rig";
  EXPECT_FALSE(source.nextCurrents());
  EXPECT_EQ(diagnostics_.count("bag_message"), 3);
}

TEST_F(RobotBagsTest, ARangeBelongsToTheAltimeterWhereTheRigHasOne) {
  const auto bag = bagWith(messages::kRange, {messages::altimeterRange({stepTime(0), 2.5}, 0)});
  const std::string keys = "{T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], range_noise_std: 0.05}\n";
  BagSource both = open(bag, "sonar0: " + keys + "altimeter0: " + keys);
  EXPECT_EQ(both.nextAltimeter()->range_m, 2.5);
  EXPECT_FALSE(both.rig().sonar);
  BagSource sonar = open(bag, "sonar0: " + keys);
  EXPECT_EQ(sonar.nextSonar()->range_m, 2.5);
  EXPECT_FALSE(sonar.nextAltimeter());
}

}  // namespace
}  // namespace lodeline

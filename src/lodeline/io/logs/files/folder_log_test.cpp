#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/log_source.h"
#include "lodeline/io/logs/open_sensor_log.h"
#include "lodeline/io/logs/test_log_folder.h"
#include "lodeline/io/logs/test_logs.h"

namespace lodeline {
namespace {

using test::hasField;
using test::hasForce;
using test::hasRate;
using test::having;
using test::kRows;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class FolderLogTest : public test::SensorLogTest {};

/// The three tables of phyphox in one of its layouts.
std::vector<std::pair<std::string, std::string>> phyphox(char separator, char mark) {
  const auto table = [&](const std::string& name, const std::string& unit, double x, double y, double z,
                         double rate_hz, double first_s) {
    const std::string s(1, separator);
    std::string text =
        fmt::format("\"Time (s)\"{0}\"{1} x ({2})\"{0}\"{1} y ({2})\"{0}\"{1} z ({2})\"\n", s, name, unit);
    for (int i = 0; i < kRows; ++i) {
      std::string row =
          fmt::format("{:.6E}{}{:.6E}{}{:.6E}{}{:.6E}\n", first_s + i / rate_hz, s, x, s, y, s, z);
      if (mark == ',') std::replace(row.begin(), row.end(), '.', ',');
      text += row;
    }
    return text;
  };
  return {{"Accelerometer.csv", table("Acceleration", "m/s^2", 0.5, 0.0, 9.8, 50.0, 0.003)},
          {"Gyroscope.csv", table("Gyroscope", "rad/s", 0.1, 0.2, 0.3, 50.0, 0.0)},
          {"Linear Acceleration.csv", table("Linear Acceleration", "m/s^2", 0.01, 0.0, 0.02, 50.0, 0.0)},
          {"Magnetometer.csv", table("Magnetic field", "\u00b5T", 20.0, 0.0, -40.0, 10.0, 0.05)}};
}

TEST_F(FolderLogTest, ReadsAFolderOfPhyphoxInEveryLayout) {
  for (const auto& [separator, mark] :
       {std::pair(',', '.'), {'\t', '.'}, {';', ','}, {'\t', ','}, {';', '.'}}) {
    diagnostics_ = Diagnostics();
    std::filesystem::create_directories(folder_ / "meta");
    write("meta/time.csv", "\"event\",\"experiment time\"\n\"START\",0.0\n");
    for (const auto& [name, text] : phyphox(separator, mark)) write(name, text);
    const std::vector<LogReading> readings = read(folder_);
    const auto rates = having(readings, hasRate), forces = having(readings, hasForce);
    const auto fields = having(readings, hasField);
    ASSERT_EQ(rates.size(), size_t{kRows}) << separator << mark;
    ASSERT_EQ(forces.size(), size_t{kRows});
    EXPECT_EQ(rates[1].time.nanoseconds(), 20'000'000);
    EXPECT_EQ(forces[1].time.nanoseconds(), 23'000'000);
    EXPECT_EQ(*forces[1].specific_force, Vec3(0.5, 0.0, 9.8)) << "with gravity";
    EXPECT_NEAR((*fields[1].field - Vec3(20e-6, 0, -40e-6)).norm(), 0.0, 1e-15);
    EXPECT_TRUE(std::is_sorted(readings.begin(), readings.end(),
                               [](const auto& a, const auto& b) { return a.time < b.time; }));
    EXPECT_THAT(finding("log_content"), HasSubstr("accelerometer from Accelerometer.csv in m/s^2"));
    LogSource source(folder_, &diagnostics_);
    EXPECT_NEAR(source.rig().imu.rate_hz, 50.0, 0.1);
    EXPECT_NEAR(source.rig().magnetometer->rate_hz, 10.0, 0.1);
    EXPECT_EQ(source.nextImu()->specific_force_B, Vec3(0.5, 0.0, 9.8));
  }
}

TEST_F(FolderLogTest, ReadsTheZipThatATelephoneGives) {
  test::ZipBytes zip;
  bool is_deflated = false;
  for (const auto& [name, text] : phyphox(',', '.'))
    zip.add("recording/" + name, text, is_deflated = !is_deflated);
  zip.add("recording/meta/device.csv", "\"property\",\"value\"\n\"deviceModel\",\"x\"\n");
  const auto path = write("recording.zip", zip.bytes());
  EXPECT_EQ(having(read(path), hasRate).size(), size_t{kRows});
  const std::string bytes = zip.bytes();
  EXPECT_THAT([&] { isSensorLog(write("cut.zip", bytes.substr(0, bytes.size() - 200))); },
              ThrowsMessage<InputError>(HasSubstr("cut.zip")));
  test::ZipBytes other;
  other.add("readme.txt", "nothing of use");
  EXPECT_THAT([&] { isSensorLog(write("other.zip", other.bytes())); },
              ThrowsMessage<InputError>(HasSubstr("unpack")));
}

TEST_F(FolderLogTest, TellsOfDamageWithinAZip) {
  test::ZipBytes zip;
  zip.add("Magnetometer.csv",
          rows("\"Time (s)\",\"X (\u00b5T)\",\"Y (\u00b5T)\",\"Z (\u00b5T)\"", "{0:.3f},20.5,{0:.5f},-40.0",
               10.0),
          false);
  for (int i = 0; i < 30; ++i) zip.add(fmt::format("note{}.txt", i), "x");
  zip.add("Gyroscope.csv", phyphox(',', '.')[1].second);
  std::string bytes = zip.bytes();
  const size_t name = bytes.find("Gyroscope.csv");
  bytes.replace(name + 40, 20, std::string(20, '\xFF'));
  const std::vector<LogReading> readings = read(write("damaged.zip", bytes));
  EXPECT_EQ(having(readings, hasField).size(), size_t{kRows}) << "the other table is still read";
  EXPECT_FALSE(sensors_.has_gyroscope);
}

std::string sensorLogger(double x, double y, double z) {
  std::string text = "time,seconds_elapsed,z,y,x\n";
  for (int64_t i = 0; i < kRows; ++i) {
    text += fmt::format("{},{:.6f},{},{},{}\n", 1'795'000'000'000'000'000LL + i * 10'000'000,
                        0.01 * static_cast<double>(i), z, y, x);
  }
  return text;
}
std::string metadata(const std::string& platform, const std::string& standardisation) {
  return "version,device name,recording epoch "
         "time,platform,appVersion,standardisation\n3,phone,1795000000000," +
         platform + ",1.47," + standardisation + "\n";
}

TEST_F(FolderLogTest, ReadsSensorLoggerOfAndroid) {
  write("Accelerometer.csv", sensorLogger(0.01, 0.02, 0.03));
  write("TotalAcceleration.csv", sensorLogger(0.5, 0.0, 9.8));
  write("Gyroscope.csv", sensorLogger(0.1, 0.2, 0.3));
  write("Gravity.csv", sensorLogger(0.4, 0.0, 9.7));
  write("Magnetometer.csv", sensorLogger(1.0, 2.0, 3.0));
  write("MagnetometerUncalibrated.csv", sensorLogger(20.0, 0.0, -40.0));
  write("WatchMagnetometer.csv", sensorLogger(99.0, 0.0, 0.0));
  write("Orientation.csv", "time,seconds_elapsed,qz,qy,qx,qw,roll,pitch,yaw\n1,0.0,0,0,0,1,0,0,0\n");
  write("Metadata.csv", metadata("android", "false"));
  const std::vector<LogReading> readings = read(folder_);
  EXPECT_EQ(*having(readings, hasForce)[3].specific_force, Vec3(0.5, 0.0, 9.8));
  EXPECT_EQ(*having(readings, hasRate)[3].angular_velocity, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(having(readings, hasRate)[3].time.nanoseconds(), 1'795'000'000'030'000'000LL);
  EXPECT_NEAR((*having(readings, hasField)[3].field - Vec3(20e-6, 0, -40e-6)).norm(), 0.0, 1e-15)
      << "the readings that the telephone did not correct";
  EXPECT_TRUE(sensors_.states_field_unit);
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 0);
}

TEST_F(FolderLogTest, AddsGravityAndTurnsTheSignOfAnIphone) {
  write("Accelerometer.csv", sensorLogger(0.01, 0.02, 0.03));
  write("Gravity.csv", sensorLogger(0.1, 0.0, -9.8));
  write("Gyroscope.csv", sensorLogger(0.1, 0.2, 0.3));
  for (const auto& [standardisation, sign] : {std::pair("false", -1.0), {"true", 1.0}}) {
    diagnostics_ = Diagnostics();
    write("Metadata.csv", metadata("ios", standardisation));
    const std::vector<LogReading> readings = read(folder_);
    const auto forces = having(readings, hasForce);
    ASSERT_EQ(forces.size(), size_t{kRows});
    EXPECT_NEAR((*forces[5].specific_force - sign * Vec3(0.11, 0.02, -9.77)).norm(), 0.0, 1e-12);
    EXPECT_EQ(diagnostics_.count("log_axes"), sign < 0.0 ? 1 : 0);
  }
  std::filesystem::remove(folder_ / "Gravity.csv");
  EXPECT_TRUE(having(read(folder_), hasForce).empty());
  EXPECT_EQ(diagnostics_.count("log_no_gravity"), 1);
}

}  // namespace
}  // namespace lodeline

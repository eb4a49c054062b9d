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
using test::raws;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class AutopilotLogTest : public test::SensorLogTest {};

/// A log of PX4: IMU at 100 Hz, two magnetometers in gauss, pressure in hPa and
/// current.
std::string px4Log(int32_t accelerometer_delay_us = 0) {
  test::ULogBytes log;
  log.flags(0)
      .format(
          "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t "
          "gyro_integral_dt;"
          "int32_t accelerometer_timestamp_relative;float[3] "
          "accelerometer_m_s2;")
      .format(
          "sensor_mag:uint64_t timestamp;uint64_t "
          "timestamp_sample;uint32_t device_id;float x;float y;float z;")
      .format("sensor_baro:uint64_t timestamp;float pressure;")
      .format("battery_status:uint64_t timestamp;float voltage_v;float current_a;")
      .subscribe(0, "sensor_combined")
      .subscribe(1, "sensor_mag", 0)
      .subscribe(2, "sensor_mag", 1)
      .subscribe(3, "sensor_baro")
      .subscribe(4, "battery_status");
  for (uint64_t i = 0; i < kRows; ++i) {
    const uint64_t t = 1'000'000 + 10'000 * i;
    log.data(0, raws<uint64_t, float, float, float, uint32_t>(t, 0.1F, 0.2F, 0.3F, 10000) +
                    raws<int32_t, float, float, float>(accelerometer_delay_us, 0.5F, 0.0F,
                                                       -9.8F - 0.01F * static_cast<float>(i)));
    log.data(1,
             raws<uint64_t, uint64_t, uint32_t, float, float, float>(t + 500, t + 300, 7, 0.2F, 0.0F, 0.4F));
    log.data(2,
             raws<uint64_t, uint64_t, uint32_t, float, float, float>(t + 600, t + 400, 8, 9.0F, 0.0F, 0.0F));
    log.data(3, raws<uint64_t, float>(t, 1013.25F));
    log.data(4, raws<uint64_t, float, float>(t, 16.0F, 12.5F));
  }
  return log.bytes();
}

/// A log of ArduPilot with and without the units of its fields.
std::string ardupilotLog(bool has_units, const char* field_unit = "G") {
  test::DataFlashBytes log;
  if (has_units) log.units();
  log.format(20, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.format(21, 3 + 8 + 1 + 6, "MAG", "QBhhh", "TimeUS,I,MagX,MagY,MagZ");
  log.format(22, 3 + 8 + 1 + 4, "BARO", "QBf", "TimeUS,I,Press");
  log.format(23, 3 + 8 + 1 + 4, "BAT", "QBf", "TimeUS,Instance,Curr");
  if (has_units) {
    log.unitsOf(20, "s#EEEooo", "F-000000");
    log.unitsOf(21, (std::string("s#") + field_unit + field_unit + field_unit).c_str(), "F-CCC");
    log.unitsOf(22, "s#P", "F-0").unitsOf(23, "s#A", "F-0");
  }
  for (uint64_t i = 0; i < kRows; ++i) {
    const uint64_t t = 2'000'000 + 20'000 * i;
    for (uint8_t instance = 0; instance < 2; ++instance) {
      log.message(20, raws<uint64_t, uint8_t, float, float, float>(t, instance, 0.1F, 0.2F, 0.3F) +
                          raws<float, float, float>(instance, 0.0F, -9.8F));
    }
    log.message(21, raws<uint64_t, uint8_t, int16_t, int16_t, int16_t>(t + 100, 0, 200, -50, 400));
    log.message(22, raws<uint64_t, uint8_t, float>(t, 0, 150000.0F));
    log.message(23, raws<uint64_t, uint8_t, float>(t, 0, 7.5F));
  }
  return log.bytes();
}

TEST_F(AutopilotLogTest, ReadsALogOfPx4) {
  const std::vector<LogReading> readings = read(write("log.ulg", px4Log()));
  EXPECT_TRUE(sensors_.has_gyroscope && sensors_.has_accelerometer && sensors_.has_magnetometer);
  EXPECT_TRUE(sensors_.states_field_unit);
  const auto rates = having(readings, hasRate), forces = having(readings, hasForce);
  ASSERT_EQ(rates.size(), size_t{kRows});
  ASSERT_EQ(forces.size(), size_t{kRows});
  EXPECT_EQ(rates[2].time.nanoseconds(), 1'020'000'000);
  EXPECT_EQ(forces[2].time, rates[2].time);
  EXPECT_NEAR((*rates[2].angular_velocity - Vec3(0.1, 0.2, 0.3)).norm(), 0.0, 1e-7);
  EXPECT_NEAR((*forces[2].specific_force - Vec3(0.5, 0.0, -9.82)).norm(), 0.0, 1e-5);
  const auto fields = having(readings, hasField);
  ASSERT_EQ(fields.size(), size_t{kRows});
  EXPECT_EQ(fields[0].time.nanoseconds(), 1'000'300'000) << "the time of the sample";
  EXPECT_NEAR((*fields[0].field - Vec3(20e-6, 0, 40e-6)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(*having(readings, [](const LogReading& r) { return r.pressure_Pa.has_value(); })[0].pressure_Pa,
              101325.0, 1.0);
  const auto currents = having(readings, [](const LogReading& r) { return !r.currents.empty(); });
  ASSERT_FALSE(currents.empty());
  EXPECT_EQ(currents[0].currents[0].current_A, 12.5);
  EXPECT_THAT(finding("log_content"), AllOf(HasSubstr("PX4"), HasSubstr("sensor_combined 0 in rad/s"),
                                            HasSubstr("sensor_mag 0 in gauss"), HasSubstr("Pa or hPa"),
                                            HasSubstr("battery_status 0 in A")));
  EXPECT_THAT(finding("log_other_sources"), HasSubstr("sensor_mag 1 (40)"));
}

/// Rows of an IMU of ArduPilot at 100 Hz, a battery at every fourth of them, and three motors at every
/// second; the third motor never takes a current.
std::string ardupilotCurrents() {
  test::DataFlashBytes log;
  log.format(20, 3 + 8 + 1 + 24, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
  log.format(23, 3 + 8 + 1 + 4, "BAT", "QBf", "TimeUS,Instance,Curr");
  log.format(24, 3 + 8 + 1 + 8, "ESC", "QBff", "TimeUS,Instance,RPM,Curr");
  for (uint64_t i = 0; i < 200; ++i) {
    const uint64_t t = 2'000'000 + 10'000 * i;
    const auto number = static_cast<float>(i);
    log.message(20, raws<uint64_t, uint8_t, float, float, float>(t, 0, 0.1F, 0.2F, 0.3F) +
                        raws<float, float, float>(0.0F, 0.0F, -9.8F));
    if (i % 4 == 0) log.message(23, raws<uint64_t, uint8_t, float>(t, 0, 100.0F + number));
    for (uint8_t motor = 0; i % 2 == 0 && motor < 3; ++motor)
      log.message(24, raws<uint64_t, uint8_t, float, float>(t, motor, 900.0F,
                                                            motor == 2 ? 0.0F : number + 0.25F * motor));
  }
  return log.bytes();
}

TEST_F(AutopilotLogTest, TakesTheCurrentsOfBatteryAndMotors) {
  LogSource source(write("log.BIN", ardupilotCurrents()), &diagnostics_);
  ASSERT_TRUE(source.rig().currents);
  EXPECT_THAT(source.rig().currents->channels, ElementsAre("battery_0", "esc_0", "esc_1"));
  EXPECT_NEAR(source.rig().currents->rate_hz, 50.0, 0.1);
  // The second motor has no reading yet when the first reports for the first time.
  const std::optional<CurrentSample> first = source.nextCurrents(), second = source.nextCurrents();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->time.nanoseconds(), 2'020'000'000);
  EXPECT_THAT(first->currents_A, ElementsAre(100.0, 2.0, 0.25));
  EXPECT_THAT(second->currents_A, ElementsAre(104.0, 4.0, 2.25));
  EXPECT_TRUE(source.nextImu());
}

TEST_F(AutopilotLogTest, TakesTheCurrentsOfPx4sMotors) {
  test::ULogBytes log;
  log.flags(0)
      .format("sensor_combined:uint64_t timestamp;float[3] gyro_rad;float[3] accelerometer_m_s2;")
      .format("esc_report:uint64_t timestamp;float esc_voltage;float esc_current;")
      .format("esc_status:uint64_t timestamp;uint8_t esc_count;uint8_t[7] _padding0;esc_report[8] esc;")
      .subscribe(0, "sensor_combined")
      .subscribe(1, "esc_status");
  for (uint64_t i = 0; i < 100; ++i) {
    const uint64_t t = 1'000'000 + 10'000 * i;
    log.data(
        0, raws<uint64_t, float, float, float>(t, 0.1F, 0.2F, 0.3F) + raws<float, float, float>(0, 0, -9.8F));
    std::string status = raws<uint64_t, uint8_t>(t, 2) + std::string(7, '\0');
    for (int motor = 0; motor < 8; ++motor)
      status += raws<uint64_t, float, float>(t, 16.0F, motor < 2 ? 1.5F + static_cast<float>(motor) : 0.0F);
    log.data(1, status);
  }
  LogSource source(write("log.ulg", log.bytes()), &diagnostics_);
  ASSERT_TRUE(source.rig().currents);
  EXPECT_THAT(source.rig().currents->channels, ElementsAre("esc_0", "esc_1"));
  EXPECT_THAT(source.nextCurrents()->currents_A, ElementsAre(1.5, 2.5));
}

TEST_F(AutopilotLogTest, TakesTheTimeOfTheAccelerometer) {
  LogSource source(write("log.ulg", px4Log(-4000)), &diagnostics_);
  // The force decreases by 0.01 m/s^2 in 10 ms. Its samples are 4 ms early.
  for (int i = 0; i < 20; ++i) {
    const std::optional<ImuSample> sample = source.nextImu();
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->time.nanoseconds(), 1'000'000'000 + 10'000'000LL * i);
    EXPECT_NEAR(sample->specific_force_B.z(), -9.8 - 0.01 * i - 0.004, 1e-5);
  }
}

TEST_F(AutopilotLogTest, ReadsALogOfArduPilot) {
  for (const bool has_units : {true, false}) {
    diagnostics_ = Diagnostics();
    const std::vector<LogReading> readings = read(write("log.BIN", ardupilotLog(has_units)));
    EXPECT_TRUE(sensors_.has_whole_imu);
    const auto imu = having(readings, hasRate), fields = having(readings, hasField);
    ASSERT_EQ(imu.size(), size_t{kRows}) << "one of the two IMUs";
    EXPECT_EQ(imu[1].time.nanoseconds(), 2'020'000'000);
    EXPECT_NEAR((*imu[1].specific_force - Vec3(0.0, 0.0, -9.8)).norm(), 0.0, 1e-6);
    ASSERT_EQ(fields.size(), size_t{kRows});
    EXPECT_NEAR((*fields[0].field - Vec3(20e-6, -5e-6, 40e-6)).norm(), 0.0, 1e-12) << has_units;
    EXPECT_THAT(finding("log_content"), HasSubstr(has_units ? "MAG 0 in Gauss" : "MAG 0 in mgauss"));
    EXPECT_EQ(finding("log_content").find("documentation") == std::string::npos, has_units);
  }
}

TEST_F(AutopilotLogTest, RefusesUnitsThatItDoesNotKnow) {
  const auto path = write("log.BIN", ardupilotLog(true, "k"));  // deg/s for a field
  EXPECT_THAT([&] { openSensorLog(path, {}, &diagnostics_); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("deg/s"), HasSubstr("MagX"))));
}

TEST_F(AutopilotLogTest, TellsOfDamageAndOfALogWithoutSensors) {
  std::string bytes = ardupilotLog(true);
  bytes.insert(bytes.size() - 100, "garbage");
  bytes.pop_back();
  EXPECT_GT(read(write("log.BIN", bytes)).size(), size_t{3 * kRows});
  EXPECT_EQ(diagnostics_.count("log_damaged"), 1);
  EXPECT_EQ(diagnostics_.count("log_cut_off"), 1);
  test::DataFlashBytes empty;
  const auto path = write("empty.BIN", empty.bytes());
  EXPECT_THAT([&] { openSensorLog(path, {}, &diagnostics_); },
              ThrowsMessage<InputError>(HasSubstr("IMU and MAG")));
}

TEST_F(AutopilotLogTest, IsRecognizedByContentAndNotByName) {
  EXPECT_TRUE(isSensorLog(write("anything", px4Log())));
  EXPECT_FALSE(isSensorLog(folder_)) << "without a table";
  EXPECT_FALSE(isSensorLog(folder_ / "absent"));
  write("places.csv", "name,latitude\na,1\n");
  EXPECT_FALSE(isSensorLog(folder_));
  EXPECT_THAT([&] { isSensorLog(write("film.mp4", std::string("\0\0\0\x18") + "ftypmp42")); },
              ThrowsMessage<InputError>(HasSubstr("film")));
}

}  // namespace
}  // namespace lodeline

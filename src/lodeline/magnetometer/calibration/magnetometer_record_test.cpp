#include "lodeline/magnetometer/calibration/magnetometer_record.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/magnetometer/iron/test_cloud.h"

namespace lodeline {
namespace {

class MagnetometerRecordTest : public ::testing::Test {
 protected:
  MagnetometerRecord read(const std::string& name, const RecordOptions& options = {}) {
    return readMagnetometerRecord(folder_.path() / name, options, &diagnostics_);
  }

  /// Rows of readings of a 45 uT field in a unit; `stamp` gives the start of each row.
  template <typename Stamp>
  static std::string rows(double factor, const Stamp& stamp) {
    std::string text;
    int i = 0;
    for (const Vec3& reading : test::cloud({}, 100)) {
      const Vec3 m = 45e-6 * factor * reading;
      text += fmt::format("{}{},{},{}\n", stamp(i++), m.x(), m.y(), m.z());
    }
    return text;
  }
  static std::string none(int) { return ""; }
  static std::string nanoseconds(int i) {
    return fmt::format("{},", 1'700'000'000'000'000'000LL + i * 20'000'000LL);
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(MagnetometerRecordTest, TellsTheUnitOfBareRowsByTheirSize) {
  for (const auto& [factor, name] : {std::pair(1.0, "T"), std::pair(1e6, "uT"), std::pair(1e9, "nT"),
                                     std::pair(1e4, "G"), std::pair(1e7, "mG")}) {
    folder_.write("rows.txt", rows(factor, none));
    Diagnostics diagnostics;
    const MagnetometerRecord record = readMagnetometerRecord(folder_.path() / "rows.txt", {}, &diagnostics);
    EXPECT_FALSE(record.has_times);
    EXPECT_FALSE(record.is_raw);
    ASSERT_EQ(record.magnetometer.size(), 100u);
    EXPECT_NEAR(record.magnetometer[7].field_M.x(), 45e-6 * test::cloud({}, 100)[7].x(), 1e-12) << name;
    EXPECT_EQ(diagnostics.count("magnetometer_unit"), 1);
    EXPECT_THAT(diagnostics.ranked()[0].first_message, ::testing::HasSubstr(name));
  }
}

TEST_F(MagnetometerRecordTest, TakesTheFieldOfXsensAsRaw) {
  // 45 uT as a share of 50 uT: by its size it would be gauss.
  folder_.write("mtx.txt",
                "// Update Rate: 100.0Hz\nPacketCounter,SampleTimeFine,Mag_X,Mag_Y,Mag_Z\n" +
                    rows(1.0 / 50e-6, [](int i) { return fmt::format("{},{},", i, 5000 + 100 * i); }));
  const MagnetometerRecord record = read("mtx.txt");
  EXPECT_TRUE(record.is_raw);
  EXPECT_TRUE(record.has_times);
  EXPECT_EQ((record.magnetometer[1].time - record.magnetometer[0].time).seconds(), 0.01);
  EXPECT_NEAR(record.magnetometer[7].field_M.x(), 0.9 * test::cloud({}, 100)[7].x(), 1e-5);
  EXPECT_EQ(diagnostics_.count("magnetometer_relative"), 1);
}

TEST_F(MagnetometerRecordTest, TakesTheUnitThatIsGiven) {
  folder_.write("rows.txt", rows(1e6, none));
  RecordOptions options;
  options.unit = FieldUnit::Raw;
  EXPECT_TRUE(read("rows.txt", options).is_raw);
  options.unit = FieldUnit::Microtesla;
  EXPECT_LT(read("rows.txt", options).magnetometer[0].field_M.norm(), 1e-4);
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 0);
  options.unit = FieldUnit::Milligauss;
  read("rows.txt", options);
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 1);
}

TEST_F(MagnetometerRecordTest, ReadsStampsAndCutsAPart) {
  folder_.write("ns.csv", rows(1e6, nanoseconds));
  folder_.write("s.txt", rows(1e6, [](int i) { return fmt::format("{} ", 12.5 + 0.02 * i); }));
  for (const char* name : {"ns.csv", "s.txt"}) {
    RecordOptions options;
    options.from_s = 0.5;
    options.to_s = 1.0;
    const MagnetometerRecord record = read(name, options);
    EXPECT_TRUE(record.has_times);
    EXPECT_EQ(record.magnetometer.size(), 26u) << name;
    options.from_s = 5.0;
    options.to_s = 6.0;
    EXPECT_THROW(read(name, options), UsageError);
  }
  folder_.write("none.txt", rows(1e6, none));
  RecordOptions options;
  options.to_s = 1.0;
  EXPECT_THROW(read("none.txt", options), UsageError);
}

TEST_F(MagnetometerRecordTest, ReadsATableWithInertialReadings) {
  std::string text = "t [s],wx [deg/s],wy [deg/s],wz [deg/s],ax [g],ay [g],az [g],mx [uT],my [uT],mz [uT]\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("{},1,2,3,0,0,1,20,{},-40\n", 0.01 * i, i);
  folder_.write("table.csv", text);
  const MagnetometerRecord record = read("table.csv");
  EXPECT_EQ(record.imu.size(), 50u);
  EXPECT_NEAR(record.imu[3].specific_force_B.z(), 9.80665, 1e-9);
  EXPECT_NEAR(record.magnetometer[3].field_M.x(), 20e-6, 1e-12);
  RecordOptions options;
  options.unit = FieldUnit::Gauss;
  EXPECT_THROW(read("table.csv", options), UsageError);
}

TEST_F(MagnetometerRecordTest, ReadsAFolderWithAndWithoutImuAndCorrectsItsUnit) {
  folder_.write("dive/mav0/mag0/data.csv",
                "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n" + rows(1e6, nanoseconds));
  MagnetometerRecord record = read("dive");
  EXPECT_TRUE(record.imu.empty());
  EXPECT_FALSE(record.body_from_magnetometer);
  EXPECT_LT(record.magnetometer[0].field_M.norm(), 1e-4);
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 1);

  folder_.write("dive/mav0/imu0/data.csv",
                "1700000000000000000,0,0,0,0,0,9.8\n1700000000005000000,0,0,0,0,0,9.8\n");
  folder_.write("dive/mav0/mag0/sensor.yaml",
                "T_BS: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: 50\n"
                "magnetometer_noise_density: 1.0e-8\n");
  record = read("dive");
  EXPECT_EQ(record.imu.size(), 2u);
  ASSERT_TRUE(record.body_from_magnetometer);
  EXPECT_LT((*record.body_from_magnetometer * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
}

TEST_F(MagnetometerRecordTest, ExplainsWhatItCannotRead) {
  EXPECT_THROW(read("absent"), InputError);
  folder_.write("dive/mav0/imu0/data.csv", "1,0,0,0,0,0,9.8\n");
  EXPECT_THROW(read("dive"), InputError);
  folder_.write("five.txt", "1 2 3 4 5\n");
  EXPECT_THROW(read("five.txt"), InputError);
  folder_.write("empty.txt", "\n");
  EXPECT_THROW(read("empty.txt"), InputError);
  folder_.write("odd.txt", rows(1e6, none) + "1,2\nnan,1,2\nx,1,2\n");
  EXPECT_EQ(read("odd.txt").magnetometer.size(), 100u);
  EXPECT_EQ(diagnostics_.count("csv_row"), 3);
}

/// A table of readings of a 45 uT field: `header`, then one `row` per reading with the fields {s} {ms} {us}
/// {ns} of the time and {x} {y} {z} in `per_uT` of the unit.
struct TableLayout {
  const char* what;
  const char* header;
  const char* row;
  double per_uT;
};

TEST_F(MagnetometerRecordTest, ReadsTheTablesOfTelephonesAutopilotsAndSpreadsheets) {
  const std::vector<TableLayout> layouts = {
      {"phyphox, Android",
       "\"Time (s)\",\"Magnetic field x (\u00b5T)\",\"Magnetic field y (\u00b5T)\",\"Magnetic field z "
       "(\u00b5T)\","
       "\"Absolute field (\u00b5T)\"\n",
       "{s:e},{x:e},{y:e},{z:e},45\n", 1.0},
      {"phyphox, iOS", "\"Time (s)\",\"X (\u00b5T)\",\"Y (\u00b5T)\",\"Z (\u00b5T)\"\n",
       "{s:e},{x:e},{y:e},{z:e}\n", 1.0},
      {"Sensor Logger", "time,seconds_elapsed,z,y,x\n", "{ns},{s},{z},{y},{x}\n", 1.0},
      {"PX4", "timestamp,timestamp_sample,device_id,x,y,z,temperature,error_count\n",
       "{us},{us},396825,{x},{y},{z},35.2,0\n", 0.01},
      {"MotionCal", "", "Raw:4,17,8183,-1,-3,1,{x:.0f},{y:.0f},{z:.0f}\n", 10.0},
      {"SensorConnect",
       "DATA_START\nGPS TFlags,GPS Week,GPS TOW,X Accel [x8004],Y Accel [x8004],Z Accel [x8004],X Gyro "
       "[x8005],"
       "Y Gyro [x8005],Z Gyro [x8005],X Mag [x8006],Y Mag [x8006],Z Mag [x8006]\n",
       "6,2430,{s},0,0,1,0,0,0,{x},{y},{z}\n", 0.01},
      {"AndroSensor",
       "ACCELEROMETER X (m/s\xB2),ACCELEROMETER Y (m/s\xB2),ACCELEROMETER Z (m/s\xB2),GYROSCOPE X (rad/s),"
       "GYROSCOPE Y (rad/s),GYROSCOPE Z (rad/s),MAGNETIC FIELD X (\xB5T),MAGNETIC FIELD Y (\xB5T),"
       "MAGNETIC FIELD Z (\xB5T),Time since start in ms \n",
       "0,0,9.8,0,0,0,{x},{y},{z},{ms}\n", 1.0},
      {"a spreadsheet's byte order mark", "\xEF\xBB\xBFt [s],mx [uT],my [uT],mz [uT]\n", "{s},{x},{y},{z}\n",
       1.0},
  };
  for (const TableLayout& layout : layouts) {
    std::string text = layout.header;
    int i = 0;
    for (const Vec3& reading : test::cloud({}, 100)) {
      const Vec3 m = 45.0 * layout.per_uT * reading;
      const int ms = 20 * i++;
      const int64_t us = 5'000'000LL + 1000LL * ms;
      text += fmt::format(fmt::runtime(layout.row), fmt::arg("s", 0.001 * ms), fmt::arg("ms", ms),
                          fmt::arg("us", us), fmt::arg("ns", 1'795'000'000'000'000'000LL + 1'000'000LL * ms),
                          fmt::arg("x", m.x()), fmt::arg("y", m.y()), fmt::arg("z", m.z()));
    }
    folder_.write("table.csv", text);
    const MagnetometerRecord record = read("table.csv");
    ASSERT_EQ(record.magnetometer.size(), 100u) << layout.what;
    const Vec3 expected_T = 45e-6 * test::cloud({}, 100)[7];
    EXPECT_LT((record.magnetometer[7].field_M - expected_T).norm(), 0.1e-6) << layout.what;
    if (record.has_times) {
      EXPECT_NEAR((record.magnetometer[7].time - record.magnetometer[6].time).seconds(), 0.02, 1e-6)
          << layout.what;
    }
    EXPECT_EQ(record.has_times, std::string(layout.what) != "MotionCal");
  }
}

TEST_F(MagnetometerRecordTest, ReadsSemicolonsAndDecimalCommas) {
  std::string text = "t [s];mx [uT];my [uT];mz [uT]\n0,00;12,5;-3;40\n0,02;12,5;-3;40\n";
  folder_.write("table.csv", text);
  const MagnetometerRecord record = read("table.csv");
  ASSERT_EQ(record.magnetometer.size(), 2u);
  EXPECT_NEAR(record.magnetometer[1].field_M.x(), 12.5e-6, 1e-15);
}

}  // namespace
}  // namespace lodeline

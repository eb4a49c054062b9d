#include "lodeline/io/csv/plain_csv.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class PlainCsvTest : public ::testing::Test {
 protected:
  PlainCsvTest() : file_(std::filesystem::temp_directory_path() / ("lodeline_plain_" + name() + ".csv")) {}
  ~PlainCsvTest() override { std::filesystem::remove(file_); }

  static std::string name() { return ::testing::UnitTest::GetInstance()->current_test_info()->name(); }

  std::vector<PlainReading> read(const std::string& text) {
    std::ofstream(file_) << text;
    PlainCsv csv(file_, &diagnostics_);
    std::vector<PlainReading> readings;
    for (PlainReading reading; csv.next(&reading);) readings.push_back(reading);
    return readings;
  }

  void expectRefused(const std::string& text, const char* why) {
    try {
      read(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
      EXPECT_THAT(error.what(), HasSubstr(file_.filename().string()));
    }
  }

  std::filesystem::path file_;
  Diagnostics diagnostics_;
};

TEST_F(PlainCsvTest, UnderstandsAHeaderWithUnitsInAnyOrder) {
  const auto readings = read(
      "mx [uT], my [uT], mz [uT], temperature [C], time [ms], gyr_x (deg/s), gyr_y (deg/s), gyr_z (deg/s), "
      "acc_x [g], acc_y [g], acc_z [g]\r\n"
      "20, 0, -40, 25.5, 1500.25, 180, 0, -90, 0, 0, 1\r\n");
  ASSERT_EQ(readings.size(), 1U);
  const PlainReading& r = readings[0];
  EXPECT_EQ(r.time.nanoseconds(), 1500250000);
  EXPECT_NEAR((*r.field - Vec3(20e-6, 0, -40e-6)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((*r.angular_velocity - Vec3(M_PI, 0, -M_PI / 2)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((*r.specific_force - Vec3(0, 0, 9.80665)).norm(), 0.0, 1e-12);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(PlainCsvTest, ReadsWindowsTicksAsTimesOfTheCalendar) {
  std::string text = "timestamp,wx,wy,wz,ax,ay,az\n", stated = "time [100 ns],wx,wy,wz,ax,ay,az\n";
  for (int i = 0; i < 60; ++i) {
    text += fmt::format("{},0,0,0,0,0,9.8\n", 134247456000000000 + i * 100000);
    stated += fmt::format("{},0,0,0,0,0,9.8\n", 5 + i * 100000);
  }
  const auto readings = read(text);
  ASSERT_EQ(readings.size(), 60U);
  EXPECT_EQ(readings[0].time.nanoseconds(), 1780272000000000000);
  EXPECT_EQ(readings[59].time.nanoseconds(), 1780272000590000000);
  ASSERT_EQ(diagnostics_.count("time_unit"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("steps of 100 ns (100 Hz)"));
  EXPECT_EQ(read(stated)[59].time.nanoseconds(), 590000500);
}

TEST_F(PlainCsvTest, RefusesCountsThatMayBeOfSeveralUnits) {
  std::string text = "time,wx,wy,wz,ax,ay,az\n";
  for (int i = 0; i < 60; ++i) text += fmt::format("{},0,0,0,0,0,9.8\n", 123 + i * 100000);
  expectRefused(text, "as nanoseconds they mean 1e+04 readings a second, as steps of 100 ns 100");
}

TEST_F(PlainCsvTest, CountsOnWhereACounterOf32BitsStartsAgain) {
  const auto readings = read(
      "micros,mx [uT],my [uT],mz "
      "[uT]\n4294947296,1,2,3\n4294957296,1,2,3\n1,1,2,3\n4294967290,1,2,3\n10001,1,2,3"
      "\n");
  ASSERT_EQ(readings.size(), 5U);
  EXPECT_EQ((readings[2].time - readings[1].time).nanoseconds(), 10'001'000);
  EXPECT_EQ((readings[3].time - readings[1].time).nanoseconds(), 9'994'000);
  EXPECT_EQ((readings[4].time - readings[1].time).nanoseconds(), 20'001'000);
  EXPECT_EQ(diagnostics_.count("csv_counter_restart"), 2);
}

TEST_F(PlainCsvTest, ReadsDatesSecondsWithNanosecondsAndFieldsThatEndInUT) {
  const auto dates = read(
      "timestamp,mag_x_uT,mag_y_uT,mag_z_uT\n2026-11-21T12:00:00.000Z,20,1,2\n"
      "2026-11-21T12:00:00.200Z,21,1,2\n");
  ASSERT_EQ(dates.size(), 2U);
  EXPECT_EQ(dates[1].time.nanoseconds(), 1795262400200000000);
  EXPECT_NEAR(dates[1].field->x(), 21e-6, 1e-12);
  const auto parts =
      read("sec,nanosec,mx [uT],my [uT],mz [uT]\n1700000000,999999999,20,1,2\n1700000001,5,20,1,2\n");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[1].time.nanoseconds(), 1700000001000000005);
}

TEST_F(PlainCsvTest, ReadsEurocHeadersToTheNanosecond) {
  const auto readings = read(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2],"
      "a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n1403715529112143517,0.1,0.2,0.3,0,0,9.8\n");
  ASSERT_EQ(readings.size(), 1U);
  EXPECT_EQ(readings[0].time.nanoseconds(), 1403715529112143517);
  EXPECT_EQ(*readings[0].angular_velocity, Vec3(0.1, 0.2, 0.3));
  EXPECT_FALSE(readings[0].field);
}

TEST_F(PlainCsvTest, TakesBareColumnsByTheirNumber) {
  const auto ten = read("0.5,0.1,0.2,0.3,0,0,9.8,2e-5,0,-4e-5\n");
  ASSERT_EQ(ten.size(), 1U);
  EXPECT_EQ(ten[0].time.nanoseconds(), 500000000);
  EXPECT_EQ(*ten[0].field, Vec3(2e-5, 0, -4e-5));
  const auto four = read("1000000000,0.2,0,-0.4\n1010000000,0.2,0.1,-0.4\n");
  ASSERT_EQ(four.size(), 2U);
  EXPECT_EQ(four[1].time.nanoseconds(), 1010000000);
  EXPECT_NEAR((*four[1].field - Vec3(2e-5, 1e-5, -4e-5)).norm(), 0.0, 1e-15);
  expectRefused("1,2,3\n", "3 columns without a header");
}

TEST_F(PlainCsvTest, TellsTheMagnetometersUnitByTheFieldsSize) {
  for (const auto& [text, finding] : {std::pair("4.5e-5", 0), std::pair("45", 1), std::pair("0.45", 1),
                                      std::pair("450", 1), std::pair("45000", 1)}) {
    diagnostics_ = Diagnostics();
    const auto readings = read(std::string("t [s],mx,my,mz\n0,0,0,") + text + "\n");
    ASSERT_EQ(readings.size(), 1U) << text;
    EXPECT_NEAR(readings[0].field->z(), 45e-6, 1e-12) << text;
    EXPECT_EQ(diagnostics_.count("magnetometer_unit"), finding) << text;
  }
  read("t [s],mx,my,mz\n0,0,0,7e7\n");
  EXPECT_EQ(diagnostics_.ranked().front().severity, Severity::Serious);
}

TEST_F(PlainCsvTest, PassesOverRowsThatCannotBeUsed) {
  const auto readings = read(
      "t [s],mx [T],my [T],mz [T]\n0,1e-5,1e-5,1e-5\n0.1,1e-5,nan,1e-5\n0.2,1e-5,1e-5\n\n0.3,x,1e-5,1e-5\n"
      "later,1e-5,1e-5,1e-5\n0.4,2e-5,1e-5,1e-5\n0.5,2e-5");
  ASSERT_EQ(readings.size(), 2U);
  EXPECT_EQ(readings[1].time.nanoseconds(), 400000000);
  EXPECT_EQ(diagnostics_.count("csv_row"), 5);
  EXPECT_EQ(readings[0].field->x(), 1e-5);
  EXPECT_THAT(diagnostics_.ranked().front().first_message, HasSubstr(".csv:"));
}

TEST_F(PlainCsvTest, KeepsInertialReadingsWhereTheFieldIsMissing) {
  const auto readings = read(
      "t,gx,gy,gz,ax,ay,az,mx [T],my [T],mz [T]\n0,0,0,0,0,0,9.8,1e-5,1e-5,1e-5\n"
      "0.1,0,0,0,0,0,9.8,1e-5,nan,1e-5\n0.2,0,0,0,0,0,9.8,,,\n0.3,0,nan,0,0,0,9.8,1e-5,1e-5,1e-5\n"
      "0.4,0,0,0,0,0,9.8,2e-5,1e-5,1e-5\n");
  ASSERT_EQ(readings.size(), 4U);
  EXPECT_TRUE(readings[0].field);
  EXPECT_FALSE(readings[1].field);
  EXPECT_FALSE(readings[2].field);
  EXPECT_TRUE(readings[3].field);
  EXPECT_TRUE(readings[1].angular_velocity && readings[2].specific_force);
  EXPECT_EQ(diagnostics_.count("csv_field"), 2);
  EXPECT_EQ(diagnostics_.count("csv_row"), 1);
}

TEST_F(PlainCsvTest, TakesTheUnitOfTimesFromTheirNameOrTheirRate) {
  const auto interval_ns = [this](const std::string& header, double step) {
    std::string text = header;
    for (int i = 0; i < 30; ++i) text += fmt::format("{},0,0,0,0,0,9.8\n", 1000 + i * step);
    const auto readings = read(text);
    return readings.size() < 2 ? 0 : (readings[1].time - readings[0].time).nanoseconds();
  };
  const std::string columns = ",gx,gy,gz,ax,ay,az\n";
  EXPECT_EQ(interval_ns("time_ms" + columns, 10), 10'000'000);
  EXPECT_EQ(interval_ns("TimeUS" + columns, 10000), 10'000'000);
  EXPECT_EQ(interval_ns("t [s]" + columns, 0.25), 250'000'000);
  EXPECT_EQ(interval_ns("timestamp" + columns, 5'000'000), 5'000'000);
  EXPECT_EQ(diagnostics_.count("time_unit"), 0);
  EXPECT_EQ(interval_ns("timestamp" + columns, 10), 10'000'000);  // uptime in milliseconds
  EXPECT_EQ(interval_ns("", 5000), 5'000'000);                    // and in microseconds, without a header
  EXPECT_EQ(diagnostics_.count("time_unit"), 2);
}

TEST_F(PlainCsvTest, AddsThePartsOfATime) {
  const auto ros = read(
      "Time,header.stamp.secs,header.stamp.nsecs,mx [T],my [T],mz "
      "[T]\n9.9,1700000000,5,1e-5,0,0\n9.9,1700000000,20000005,1e-5,0,0\n");
  ASSERT_EQ(ros.size(), 2U);
  EXPECT_EQ(ros[0].time.nanoseconds(), 1700000000000000005);
  const auto gps = read(
      "GPS Week,GPS TOW,X Mag [x8006],Y Mag [x8006],Z Mag "
      "[x8006]\n2430,300000.25,0.4,0,0\n2430,300000.5,0.4,0,0\n");
  ASSERT_EQ(gps.size(), 2U);
  EXPECT_EQ(gps[0].time.nanoseconds(), (2430LL * 604800 + 300000) * 1'000'000'000 + 250'000'000);
}

TEST_F(PlainCsvTest, TakesOneOfSeveralSensorsInOneTable) {
  const auto readings = read(
      "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n1000,0,1,0,0,0,0,9.8\n1000,1,2,0,0,0,0,9.8\n6000,0,1,0,0,0,0,"
      "9.8\n6000,1,2,0,0,0,0,9.8\n");
  ASSERT_EQ(readings.size(), 2U);
  EXPECT_EQ(readings[1].angular_velocity->x(), 1.0);
  EXPECT_EQ(diagnostics_.count("csv_instance"), 2);
}

TEST_F(PlainCsvTest, SkipsColumnsOfTimesThatAreNone) {
  const auto readings = read(
      "loggingTime(txt),time (constant),t [s],mx [T],my [T],mz [T]\n2026-11-21 "
      "10:00,3,0.5,1e-5,0,0\n2026-11-21 10:00,3,0.6,1e-5,0,0\n");
  ASSERT_EQ(readings.size(), 2U);
  EXPECT_EQ(readings[1].time.nanoseconds(), 600000000);
  expectRefused("date,mx [T],my [T],mz [T]\nnoon,1e-5,0,0\n", "holds no numbers");
}

TEST_F(PlainCsvTest, RefusesWhatItCannotUnderstand) {
  expectRefused("", "no row of numbers");
  expectRefused("t,mx,my,mz\n", "no row of numbers");
  expectRefused("mx [uT],my [uT],mz [uT]\n1,2,3\n", "names no time");
  expectRefused("t [s],x,y,z\n0,1,2,3\n", "names no time and sensor");
  expectRefused("t [s],mx [furlong],my [furlong],mz [furlong]\n0,1,2,3\n", "furlong");
  expectRefused("t [s],mx [deg/s],my [deg/s],mz [deg/s]\n0,1,2,3\n",
                "known for the magnetic field are t, ut, nt, gauss");
  expectRefused("t [fortnight],mx [T],my [T],mz [T]\n0,1,2,3\n", "'fortnight'");
  EXPECT_THROW(PlainCsv(file_.parent_path() / "absent.csv", &diagnostics_), InputError);
}

}  // namespace
}  // namespace lodeline

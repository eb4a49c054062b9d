#include "lodeline/io/euroc/csv_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class CsvReaderTest : public testing::Test {
 protected:
  std::vector<CsvRow> readAll(const std::string& text, int number_count) {
    recording_.write("some.csv", text);
    CsvReader reader(recording_.path("some.csv"), number_count, &diagnostics_);
    std::vector<CsvRow> rows;
    for (CsvRow row; reader.next(&row);) rows.push_back(row);
    return rows;
  }

  /// The message of the only finding after reading rows of two numbers.
  std::string findingOf(const std::string& text) {
    readAll(text, 2);
    const std::vector<Finding> findings = diagnostics_.ranked();
    return findings.size() == 1 && findings[0].count == 1 ? findings[0].first_message : "not one finding";
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(CsvReaderTest, ReadsRowsWithCommentsBlankLinesAndCrlf) {
  const std::vector<CsvRow> rows = readAll(
      "#timestamp [ns],x,y\r\n1403636579758555392, 1.5,-2e-3\r\n\r\n# pause\n1403636579763555584,+3,4,\n", 2);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].time.nanoseconds(), 1403636579758555392);
  EXPECT_THAT(rows[0].numbers, ElementsAre(1.5, -2e-3));
  EXPECT_THAT(rows[1].numbers, ElementsAre(3.0, 4.0));
  EXPECT_THAT(diagnostics_.ranked(), IsEmpty());
}

TEST_F(CsvReaderTest, ReadsTheTextColumnWhereThereIsOne) {
  const std::vector<CsvRow> rows = readAll("10,a b.png\r\n20\r\n30,\n", 0);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].text, "a b.png");
  EXPECT_EQ(rows[1].text, "");
  EXPECT_EQ(rows[2].text, "");
}

TEST_F(CsvReaderTest, AcceptsAHeaderWithoutHashAndColumnsThatItNames) {
  const std::vector<CsvRow> rows = readAll("stamp,x,y,temperature\n1,2,3,20.5\n2,3,4\n", 2);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_THAT(rows[0].numbers, ElementsAre(2.0, 3.0));
  EXPECT_EQ(diagnostics_.count("csv_row"), 1);
}

TEST_F(CsvReaderTest, NamesFileAndLineOfAWrongColumnCount) {
  const std::string finding = findingOf("#t,x,y\n1,2,3\n2,3\n3,4,5\n");
  EXPECT_THAT(finding, HasSubstr("some.csv:3: 2 columns where 3 are due"));
}

TEST_F(CsvReaderTest, PassesOverTwoRowsRunTogether) {
  EXPECT_THAT(findingOf("1,2,3\n2,3,43,4,5\n4,5,6\n"), HasSubstr("some.csv:2: 5 columns"));
}

TEST_F(CsvReaderTest, PassesOverNanAndInfinity) {
  EXPECT_THAT(findingOf("1,2,nan\n"), HasSubstr("'nan' in column 3 is not a finite number"));
  EXPECT_EQ(readAll("1,2,3\n2,inf,1\n3,-NaN,1\n4,5,6\n", 2).size(), 2u);
}

TEST_F(CsvReaderTest, PassesOverWordsAndBrokenStamps) {
  EXPECT_THAT(findingOf("1,2,3x\n"), HasSubstr("'3x' in column 3 is not a number"));
  EXPECT_EQ(readAll("1.5e18,2,3\n12.5,1,1\n,1,1\n99999999999999999999,1,1\n7,1,1\n", 2).size(), 1u);
}

TEST_F(CsvReaderTest, SaysThatACutOffLastLineWasCutOff) {
  EXPECT_THAT(findingOf("1,2,3\n2,3."),
              HasSubstr("some.csv:2: 2 columns where 3 are due (the file's last line"));
}

TEST_F(CsvReaderTest, AcceptsAnEmptyFileAndRefusesAMissingOne) {
  EXPECT_THAT(readAll("", 2), IsEmpty());
  EXPECT_THROW(CsvReader("/no/such.csv", 2, &diagnostics_), InputError);
  EXPECT_THROW(CsvReader(recording_.folder(), 2, &diagnostics_), InputError);
}

TEST_F(CsvReaderTest, SurvivesBinaryRubbish) {
  std::string rubbish;
  for (int i = 0; i < 4096; ++i) rubbish += static_cast<char>((i * 7919 + i / 3) & 255);
  EXPECT_THROW(readAll(rubbish, 2), InputError);  // it has zero bytes
  std::erase(rubbish, '\0');
  readAll("1,2,3\n" + rubbish, 2);
  EXPECT_GT(diagnostics_.count("csv_row"), 0);
}

class SensorFileTest : public CsvReaderTest {
 protected:
  std::vector<CsvRow> read(const std::string& text, CsvContent content) {
    CsvReader reader(bytesInMemory(text), "data.csv", content, &diagnostics_);
    std::vector<CsvRow> rows;
    for (CsvRow row; reader.next(&row);) rows.push_back(row);
    return rows;
  }
};

TEST_F(SensorFileTest, TakesColumnsByTheNamesOfTheHeader) {
  for (const char* text :
       {"#timestamp [ns],a_x,a_y,a_z,w_x,w_y,w_z\n7,4,5,6,1,2,3\n", "time,ax,ay,az,gx,gy,gz\n7,4,5,6,1,2,3\n",
        "a_z,a_y,a_x,temperature,w_x,w_y,w_z,timestamp\n6,5,4,20,1,2,3,7\n",
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
        "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n7,1,2,3,4,5,6\n",
        "# some words, about the file\n7,1,2,3,4,5,6\n"}) {
    const std::vector<CsvRow> rows = read(text, CsvContent::Imu);
    ASSERT_EQ(rows.size(), 1u) << text;
    EXPECT_EQ(rows[0].time.nanoseconds(), 7) << text;
    EXPECT_THAT(rows[0].numbers, ElementsAre(1, 2, 3, 4, 5, 6)) << text;
  }
  const std::vector<CsvRow> field =
      read("timestamp [ns],mz [uT],my [uT],mx [uT]\n7,30,20,10\n", CsvContent::Magnetometer);
  ASSERT_EQ(field.size(), 1u);
  EXPECT_NEAR(field[0].numbers[0], 1e-5, 1e-15);
  EXPECT_NEAR(field[0].numbers[2], 3e-5, 1e-15);
  const std::vector<CsvRow> depth =
      read("timestamp [ms],temperature,depth [ft]\n7.5,20,10\n", CsvContent::Depth);
  ASSERT_EQ(depth.size(), 1u);
  EXPECT_EQ(depth[0].time.nanoseconds(), 7500000);
  EXPECT_DOUBLE_EQ(depth[0].numbers[0], 3.048);
  const std::vector<CsvRow> images = read("filename,timestamp [ns]\na.png,7\nb.png,8\n", CsvContent::Images);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[1].text, "b.png");
  EXPECT_EQ(images[1].time.nanoseconds(), 8);
  const std::vector<CsvRow> truth =
      read("#timestamp,p_x,p_y,p_z,q_x,q_y,q_z,q_w,v_x\n7,1,2,3,0.1,0.2,0.3,0.9,5\n", CsvContent::TruePose);
  ASSERT_EQ(truth.size(), 1u);
  EXPECT_THAT(truth[0].numbers, ElementsAre(1, 2, 3, 0.9, 0.1, 0.2, 0.3));
  EXPECT_EQ(truth[0].text, "5");
  EXPECT_THAT(diagnostics_.ranked(), IsEmpty());
}

TEST_F(SensorFileTest, ConvertsUnitsThatTheHeaderStates) {
  const std::vector<CsvRow> rows =
      read("timestamp [ns],wx [deg/s],wy [deg/s],wz [deg/s],ax [g],ay [g],az [g]\n7,180,0,0,0,0,1\n",
           CsvContent::Imu);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(rows[0].numbers[0], M_PI, 1e-12);
  EXPECT_NEAR(rows[0].numbers[5], 9.80665, 1e-12);
}

TEST_F(SensorFileTest, RefusesAHeaderThatNamesOtherQuantities) {
  EXPECT_THROW(read("t [ns],wx,wy,wz,temp,ax,ay\n7,1,2,3,4,5,6\n", CsvContent::Imu), InputError);
  EXPECT_THROW(read("t [ns],pressure [Pa]\n7,101325\n", CsvContent::Depth), InputError);
  EXPECT_THROW(read("t [ns],mx [furlong],my [furlong],mz [furlong]\n7,1,2,3\n", CsvContent::Magnetometer),
               InputError);
  EXPECT_THROW(read("t [fortnight],depth [m]\n7,1\n", CsvContent::Depth), InputError);
}

std::string rowsEvery(double first, double step, const char* format, int count = 60) {
  std::string text = "#timestamp [ns],x,y\n";
  for (int i = 0; i < count; ++i) text += fmt::format(fmt::runtime(format), first + step * i) + ",1,2\n";
  return text;
}

class StampUnitTest : public CsvReaderTest {
 protected:
  /// Seconds from the first to the last of 60 rows of a 200 Hz IMU.
  double seconds(const std::string& text) {
    recording_.write("some.csv", text);
    CsvReader reader(recording_.path("some.csv"), 2, &diagnostics_, kInertialRate);
    std::vector<Time> times;
    for (CsvRow row; reader.next(&row);) times.push_back(row.time);
    EXPECT_EQ(times.size(), 60u);
    return times.empty() ? 0.0 : (times.back() - times.front()).seconds();
  }
};

TEST_F(StampUnitTest, IsFoundByTheRateThatASensorCanHave) {
  EXPECT_NEAR(seconds(rowsEvery(1.4e15, 5e6, "{:.0f}")), 0.295, 1e-6);
  EXPECT_THAT(diagnostics_.ranked(), IsEmpty());
  EXPECT_NEAR(seconds(rowsEvery(1.4e15, 5e3, "{:.0f}")), 0.295, 1e-6);
  ASSERT_EQ(diagnostics_.count("stamp_unit"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              testing::AllOf(HasSubstr("some.csv"), HasSubstr("microseconds"), HasSubstr("200 Hz")));
  EXPECT_NEAR(seconds(rowsEvery(1523, 5, "{:.0f}")), 0.295, 1e-6);
  EXPECT_EQ(diagnostics_.count("stamp_unit"), 2);
}

TEST_F(StampUnitTest, IsStepsOf100nsWhereTheyAreACurrentTime) {
  EXPECT_NEAR(seconds(rowsEvery(639'158'688e9, 1e5, "{:.0f}")), 0.59, 1e-4);
  ASSERT_EQ(diagnostics_.count("stamp_unit"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              testing::AllOf(HasSubstr("steps of 100 ns"), HasSubstr("100 Hz")));
}

TEST_F(StampUnitTest, OfDecimalsIsSecondsUnlessTheyAreTooLarge) {
  EXPECT_NEAR(seconds(rowsEvery(1.4e9, 0.005, "{:.6f}")), 0.295, 1e-6);
  EXPECT_NEAR(seconds(rowsEvery(1.4e18, 5e6, "{:.18e}")), 0.295, 1e-6);
  EXPECT_NEAR(seconds(rowsEvery(1.4e12, 5.0, "{:.3f}")), 0.295, 1e-6);
}

}  // namespace
}  // namespace lodeline

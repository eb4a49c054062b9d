#include "lodeline/data/csv_reader.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/base/error.h"
#include "lodeline/data/test_recording.h"

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

  /// The only finding's message after reading rows of two numbers.
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
  readAll(rubbish, 2);
  EXPECT_GT(diagnostics_.count("csv_row"), 0);
}

std::string rowsEvery(double first, double step, const char* format, int count = 60) {
  std::string text = "#timestamp [ns],x,y\n";
  for (int i = 0; i < count; ++i) text += fmt::format(fmt::runtime(format), first + step * i) + ",1,2\n";
  return text;
}

class StampUnitTest : public CsvReaderTest {
 protected:
  /// Seconds from the first to the last row of 60 in which an IMU of 200 Hz was written.
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

TEST_F(StampUnitTest, OfDecimalsIsSecondsUnlessTheyAreTooLarge) {
  EXPECT_NEAR(seconds(rowsEvery(1.4e9, 0.005, "{:.6f}")), 0.295, 1e-6);
  EXPECT_NEAR(seconds(rowsEvery(1.4e18, 5e6, "{:.18e}")), 0.295, 1e-6);
  EXPECT_NEAR(seconds(rowsEvery(1.4e12, 5.0, "{:.3f}")), 0.295, 1e-6);
}

}  // namespace
}  // namespace lodeline

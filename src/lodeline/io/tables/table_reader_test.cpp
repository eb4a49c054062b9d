#include "lodeline/io/tables/table_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

bool hasTimeAndDepth(const std::vector<ColumnName>& columns) {
  const auto has = [&](const char* word, bool greatest) {
    return std::any_of(columns.begin(), columns.end(), [&](const ColumnName& column) {
      return column.hasWord({word}) && column.hasWord({"max"}) == greatest;
    });
  };
  return has("time", false) && has("depth", false);
}

class TableReaderTest : public ::testing::Test {
 protected:
  TableReader open(const std::string& text, bool with_header = true) {
    TableOptions options;
    if (with_header) options.is_header = hasTimeAndDepth;
    return TableReader(bytesInMemory(text), "table.csv", options, &diagnostics_);
  }

  /// All rows as numbers, NaN where a cell is not a number.
  std::vector<std::vector<double>> rowsOf(const std::string& text, bool with_header = true) {
    TableReader table = open(text, with_header);
    std::vector<std::vector<double>> rows;
    while (table.next()) {
      rows.emplace_back();
      for (std::size_t i = 0; i < table.columnCount(); ++i) {
        rows.back().push_back(table.number(i).value_or(std::nan("")));
      }
    }
    return rows;
  }

  std::string firstMessage() const {
    return diagnostics_.ranked().empty() ? std::string() : diagnostics_.ranked().front().first_message;
  }

  Diagnostics diagnostics_;
};

const std::vector<double> kFirst = {0.0, 3.25};
const std::vector<double> kSecond = {10.0, -4.5};

TEST_F(TableReaderTest, ReadsEverySeparator) {
  for (const char* text :
       {"time,depth\n0,3.25\n10,-4.5\n", "time;depth\n0;3,25\n10;-4,5\n", "time\tdepth\n0\t3,25\n10\t-4.5\n",
        "time depth\n0   3.25\n10  -4.5\n", "\"time (s)\",\"depth, m\"\n\"0\",\"3,25\"\n\"10\",\"-4,5\"\n",
        "time,depth,\n0,3.25,\n10,-4.5,\n", "time, depth\n0, 3.25\n10,\t-4.5\n",
        "# time, depth\n0 3.25\n10 -4.5\n", "time,depth\r0,3.25\r10,-4.5\r",
        "time\tdepth\r\n\r\n0\t3.25\r\n10\t\u22124.5\r\n"}) {
    EXPECT_THAT(rowsOf(text), ElementsAre(kFirst, kSecond)) << text;
  }
  EXPECT_TRUE(diagnostics_.ranked().empty()) << firstMessage();
}

TEST_F(TableReaderTest, FindsTheHeaderByItsWords) {
  for (const char* text :
       {"# a log\n# time [s], depth [m]\n0,3.25\n10,-4.5\n",
        "// Start: 2026-11-21\n//\n// rate: 100\ntime,depth\n0,3.25\n10,-4.5\n",
        "%time,depth\n0,3.25\n10,-4.5\n",
        // Format of dive computers: a header and a row of the dive before those of its samples.
        "Dive Number,Max Time,Max Depth\n60,4,16.0\ntime,depth\n0,3.25\n10,-4.5\n",
        "Device;Diver\nSN 7;A;B\n\ntime;depth\n0;3.25\n10;-4.5\n", "time,depth\ns,m\n0,3.25\n10,-4.5\n",
        "time,depth\n0,3.25\ntime,depth\n10,-4.5\n", "0,3.25\ntime,depth\n10,-4.5\n"}) {
    EXPECT_THAT(rowsOf(text), ElementsAre(kFirst, kSecond)) << text;
  }
  EXPECT_TRUE(diagnostics_.ranked().empty()) << firstMessage();
}

TEST_F(TableReaderTest, AcceptsACommentThatNamesTheFirstColumnsOnly) {
  EXPECT_THAT(rowsOf("# time depth\n0 3.25 7\n10 -4.5 8\n"),
              ElementsAre(ElementsAre(0.0, 3.25, 7.0), ElementsAre(10.0, -4.5, 8.0)));
  EXPECT_EQ(diagnostics_.count("csv_columns"), 1);
}

TEST_F(TableReaderTest, TakesACommentOfMoreWordsThanColumnsAsProse) {
  EXPECT_THAT(rowsOf("# each line has a time and a depth\n0 3.25\n10 -4.5\n"), ElementsAre(kFirst, kSecond));
}

TEST_F(TableReaderTest, TakesUnitsFromTheLineBelow) {
  const TableReader table = open("time,depth\n[ms],(ft)\n0,3.25\n");
  EXPECT_EQ(table.columns()[0].unit, "ms");
  EXPECT_EQ(table.columns()[1].unit, "ft");
}

TEST_F(TableReaderTest, WithoutHeaderTheFirstRowStatesTheColumns) {
  EXPECT_THAT(rowsOf("# note\n0,3.25,\n10,-4.5,\n3,4,5\n7\n", false), ElementsAre(kFirst, kSecond));
  EXPECT_EQ(diagnostics_.count("csv_row"), 2);
  EXPECT_THAT(firstMessage(), HasSubstr("table.csv:4: 3 columns where 2 are due"));
  TableReader table = open("speed,course\n1,2\n");
  EXPECT_FALSE(table.hasHeader());
  EXPECT_EQ(table.unknownHeader(), "speed,course");
}

TEST_F(TableReaderTest, ReportsRowsThatDoNotFitAndPassesThemOver) {
  EXPECT_THAT(rowsOf("time,depth\n0,3.25\n1,2,3\n10,-4.5\n11,"), ElementsAre(kFirst, kSecond, testing::_));
  EXPECT_EQ(diagnostics_.count("csv_row"), 1);
  EXPECT_THAT(rowsOf("time,depth\n0,3.25\n10,-4.5\n11"), ElementsAre(kFirst, kSecond));
  EXPECT_THAT(firstMessage(), HasSubstr("table.csv:3"));
}

TEST_F(TableReaderTest, RefusesATableOfWhichNoRowFits) {
  EXPECT_THROW(rowsOf("time,depth\n1,2,3\n2,3,4\n"), InputError);
  try {
    rowsOf("time,depth\n0,0,3,25\n1,0,4,25\n");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("decimal commas"));
  }
  EXPECT_THROW(rowsOf("time,depth\n0,3.25\ndepth,time\n3,10\n"), InputError);  // the order changes
  EXPECT_THAT(rowsOf(""), ElementsAre());
}

TEST_F(TableReaderTest, TakesDecimalCommasBetweenBlanks) {
  EXPECT_THAT(rowsOf("0,5 3,25 7\n10,0 -4,5 8\n", false),
              ElementsAre(ElementsAre(0.5, 3.25, 7.0), ElementsAre(10.0, -4.5, 8.0)));
}

TEST_F(TableReaderTest, TakesCommasAndBlanksBetweenNumbers) {
  EXPECT_THAT(rowsOf("0.5 1,2 , 3\n0.6 4,5,6\n", false),
              ElementsAre(ElementsAre(0.5, 1.0, 2.0, 3.0), ElementsAre(0.6, 4.0, 5.0, 6.0)));
}

TEST_F(TableReaderTest, TakesOffALabelBeforeEachRow) {
  TableReader table = open("Raw:1,-2,3\nUni: 0.1,0.2,0.3\nRaw:4,5,6\n", false);
  EXPECT_EQ(table.label(), "Raw");
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.number(1), -2.0);
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.number(2), 6.0);
  EXPECT_FALSE(table.next());
}

TEST_F(TableReaderTest, KeepsAllDigitsOfTimes) {
  TableReader table = open("time;depth\n1700000000,100000001;3\n", true);
  ASSERT_TRUE(table.next());
  EXPECT_EQ(table.time_ns(0, TimeUnit::Seconds), 1700000000100000001);
}

TEST(NumberFrom, ReadsTheNotationsOfSpreadsheets) {
  EXPECT_EQ(numberFrom("1.5e3"), 1500.0);
  EXPECT_EQ(numberFrom("+7"), 7.0);
  EXPECT_EQ(numberFrom("1.234,5"), 1234.5);
  EXPECT_EQ(numberFrom("1,234.5"), 1234.5);
  EXPECT_EQ(numberFrom("1,234,567.5"), 1234567.5);
  EXPECT_TRUE(std::isnan(*numberFrom("nan")));
  for (const char* no : {"", "-", ",", "1,2,3", "1x", "0x10", "1,23.4", "AI is off", "1 2"}) {
    EXPECT_EQ(numberFrom(no), std::nullopt) << no;
  }
}

}  // namespace
}  // namespace lodeline

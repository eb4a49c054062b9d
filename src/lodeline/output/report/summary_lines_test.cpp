#include "lodeline/output/report/summary_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace lodeline {
namespace {

TEST(SummaryLines, ShortValuesTakeALine) {
  SummaryLines lines(96);
  lines.add("path", "5.37 m");
  lines.add("a name that is long", "value");
  EXPECT_EQ(lines.text(), "  path           5.37 m\n  a name that is long value\n");
}

TEST(SummaryLines, LongValuesAreWrappedBetweenWords) {
  SummaryLines lines(96);
  std::string value;
  for (int i = 0; i < 60; ++i) {
    if (i > 0) value += ' ';
    value += "word";
    value += std::to_string(i);
  }
  value += ' ';
  value.append(150, 'x');
  lines.add("warning", value);
  std::istringstream text(lines.text());
  std::string line, joined;
  int count = 0;
  while (std::getline(text, line)) {
    EXPECT_EQ(line.substr(0, 17), count++ == 0 ? "  warning        " : std::string(17, ' '));
    if (line.find('x') == std::string::npos) {
      EXPECT_LE(line.size(), 113u);
    }
    if (!joined.empty()) joined += ' ';
    joined += line.substr(17);
  }
  EXPECT_EQ(joined, value);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/util/terminal/terminal.h"

#include <gtest/gtest.h>

#include <string>

#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

TEST(Terminal, BreaksTextAtSpacesAndIndentsTheNextLines) {
  EXPECT_EQ(terminal::wrapped("one two three", 9, 2, 4), "one two\n    three");
  EXPECT_EQ(terminal::wrapped("one\ntwo", 80, 0, 2), "one\n  two");
  EXPECT_EQ(terminal::wrapped("", 10, 0, 2), "");
}

TEST(Terminal, GivesAWordThatIsTooLongItsOwnLine) {
  EXPECT_EQ(terminal::wrapped("a 0123456789 b", 6, 0, 1), "a\n 0123456789\n b");
}

TEST(Terminal, KeepsSpacesWithinALine) { EXPECT_EQ(terminal::wrapped("a   b", 80, 0, 0), "a   b"); }

TEST(Terminal, CountsCharactersAndNotBytes) {
  EXPECT_EQ(terminal::wrapped("äö üß", 5, 0, 1), "äö üß");
  EXPECT_EQ(terminal::cut("äöü", 2), "äö");
  EXPECT_EQ(terminal::cut("ab", 5), "ab");
}

TEST(Terminal, ColoursOnlyOnRequest) {
  EXPECT_EQ(terminal::coloured("x", terminal::Colour::Red, true), "\033[31mx\033[0m");
  EXPECT_EQ(terminal::coloured("x", terminal::Colour::Red, false), "x");
}

TEST(Progress, TellsPerCentAndTheRemainingTime) {
  EXPECT_EQ(progressLine("run", 0.25, 30.0, "3 m"), "run   25 %  1:30 left  3 m");
  EXPECT_EQ(progressLine("run", 0.5, 4000.0, ""), "run   50 %  1:06:40 left");
}

TEST(Progress, ClaimsNoTimeWhereItIsUnknown) {
  EXPECT_EQ(progressLine("run", std::nullopt, 30.0, "3 m"), "run  3 m");
  EXPECT_EQ(progressLine("run", 0.0, 30.0, ""), "run    0 %");
}

TEST(Progress, StaysWithinTheWhole) {
  EXPECT_EQ(progressLine("run", 1.2, 30.0, ""), "run  100 %  0:00 left");
}

}  // namespace
}  // namespace lodeline

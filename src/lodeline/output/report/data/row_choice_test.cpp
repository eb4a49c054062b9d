#include "lodeline/output/report/data/row_choice.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodeline {
namespace {

TEST(RowChoice, KeepsAllOfAShortTable) {
  EXPECT_EQ(chooseRows(4, 10, {}).rows, (std::vector<size_t>{0, 1, 2, 3}));
  EXPECT_EQ(chooseRows(4, 10, {}).stride, 1u);
  EXPECT_TRUE(chooseRows(0, 10, {}).rows.empty());
}

TEST(RowChoice, KeepsEveryNthAndTheLast) {
  const RowChoice choice = chooseRows(10, 4, {});
  EXPECT_EQ(choice.stride, 3u);
  EXPECT_EQ(choice.rows, (std::vector<size_t>{0, 3, 6, 9}));
  EXPECT_EQ(chooseRows(11, 4, {}).rows.back(), 10u);
}

TEST(RowChoice, KeepsWhereAWordChanges) {
  std::vector<std::string> status(100, "tracking");
  status[41] = "inertial";
  const RowChoice choice = chooseRows(100, 10, {&status});
  EXPECT_EQ(std::count(choice.rows.begin(), choice.rows.end(), 41), 1);
  EXPECT_EQ(std::count(choice.rows.begin(), choice.rows.end(), 42), 1);
  EXPECT_EQ(choice.rows.size(), 13u);  // 0, 10, …, 90, 99 and the two
}

TEST(RowChoice, WordsThatFlickerDoNotFillThePage) {
  std::vector<std::string> status(1000);
  for (size_t i = 0; i < status.size(); ++i) status[i] = i % 2 ? "norm" : "used";
  EXPECT_LE(chooseRows(1000, 10, {&status}).rows.size(), 11u);
}

}  // namespace
}  // namespace lodeline

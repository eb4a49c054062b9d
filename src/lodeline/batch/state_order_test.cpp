#include "lodeline/batch/state_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace lodeline {
namespace {

std::vector<size_t> byTime(size_t states) {
  std::vector<size_t> order(states);
  std::iota(order.begin(), order.end(), size_t{0});
  return order;
}

/// Tracks of 30 states along the way; with `lap` states per lap, each also covers the same place of the laps
/// before.
StateCliques circuit(size_t states, size_t lap) {
  constexpr size_t kTrack = 30;
  StateCliques cliques;
  for (size_t k = 1; k < states; ++k) cliques.push_back({k - 1, k});
  for (size_t k = 0; k + kTrack <= states; k += 3) {
    std::vector<size_t>& clique = cliques.emplace_back();
    for (size_t begin = k % lap; begin <= k; begin += lap) {
      for (size_t i = begin; i < begin + kTrack; ++i) clique.push_back(i);
    }
    std::sort(clique.begin(), clique.end());
    clique.erase(std::unique(clique.begin(), clique.end()), clique.end());
  }
  return cliques;
}

TEST(StateOrder, FindsTheNeighboursOfEachState) {
  const auto neighbours = neighboursOf(5, {{0, 1}, {1, 2, 4}, {2, 4}});
  EXPECT_EQ(neighbours[0], (std::vector<size_t>{1}));
  EXPECT_EQ(neighbours[1], (std::vector<size_t>{0, 2, 4}));
  EXPECT_TRUE(neighbours[3].empty());
  EXPECT_EQ(neighbours[4], (std::vector<size_t>{1, 2}));
}

TEST(StateOrder, SumsTheWidthsOfTheRows) {
  const auto neighbours = neighboursOf(4, {{0, 1}, {1, 2}, {2, 3}, {0, 3}});
  EXPECT_EQ(envelopeOf(neighbours, byTime(4)), 1u + 1u + 3u);
  EXPECT_EQ(envelopeOf(neighbours, {0, 1, 3, 2}), 1u + 2u + 2u);
}

TEST(StateOrder, PutsTwoLapsSideBySide) {
  constexpr size_t kStates = 2000;
  const auto neighbours = neighboursOf(kStates, circuit(kStates, kStates / 2));
  const std::vector<size_t> order = narrowOrder(neighbours);
  std::vector<size_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, byTime(kStates)) << "every state once";
  const size_t by_time = envelopeOf(neighbours, byTime(kStates)), narrow = envelopeOf(neighbours, order);
  RecordProperty("states_per_row_by_time", static_cast<int>(by_time / kStates));
  RecordProperty("states_per_row_reordered", static_cast<int>(narrow / kStates));
  // Four passes meet in the order's front, two of each lap, each as wide as a track.
  EXPECT_LT(narrow, kStates * 4 * 30 * 3 / 2);
  EXPECT_LT(narrow, by_time / 3);
  EXPECT_EQ(narrowOrder(neighbours), order);
}

TEST(StateOrder, StaysThatOfTimeWhereNothingIsNarrower) {
  const auto neighbours = neighboursOf(300, circuit(300, 300));
  EXPECT_EQ(envelopeOf(neighbours, narrowOrder(neighbours)), envelopeOf(neighbours, byTime(300)));
}

TEST(StateOrder, CoversStatesWithoutNeighbours) {
  EXPECT_EQ(narrowOrder(neighboursOf(3, {})).size(), 3u);
  EXPECT_TRUE(narrowOrder({}).empty());
}

}  // namespace
}  // namespace lodeline

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/motion/odometry_chain.h"
#include "lodeline/mapping/graph/motion/odometry_edge.h"
#include "lodeline/mapping/graph/robust/loop_support.h"
#include "lodeline/mapping/graph/robust/maximum_clique.h"
#include "lodeline/mapping/graph/robust/pairwise_consistency.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"
#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {
namespace {

TEST(ChiSquaredQuantile, AgreesWithTables) {
  EXPECT_NEAR(chiSquaredQuantile(0.95, 6), 12.5916, 1e-4);
  EXPECT_NEAR(chiSquaredQuantile(0.99, 3), 11.3449, 1e-4);
  EXPECT_THROW(chiSquaredQuantile(1.0, 6), UsageError);
}

TEST(AccidentalAgreement, IsTheShareOfRefusedLoopsThatReachACount) {
  const AccidentalAgreement accidental({0, 2, 0, 1});
  EXPECT_EQ(accidental.share(0), 1.0);
  EXPECT_EQ(accidental.share(1), 0.5);
  EXPECT_EQ(accidental.share(2), 0.25);
  EXPECT_EQ(accidental.share(3), 0.0);
  EXPECT_EQ(AccidentalAgreement(std::vector<std::ptrdiff_t>()).share(0), 0.0);
}

TEST(GraduatedWeights, EndAtTheTruncatedCost) {
  const std::vector<double> ratios{0.0, 0.5, 0.99, 1.01, 3.0, 400.0, 1e6};
  GraduatedWeights graduation(ratios);
  std::vector<double> weights;
  int rounds = 0;
  for (; rounds < 200 && !graduation.areBinary(); ++rounds) {
    weights = graduation.next(ratios);
    for (size_t i = 1; i < weights.size(); ++i) EXPECT_LE(weights[i], weights[i - 1]);
  }
  EXPECT_LT(rounds, 100);
  EXPECT_EQ(weights, (std::vector<double>{1, 1, 1, 0, 0, 0, 0}));
}

TEST(GraduatedWeights, BeginNearlyEqual) {
  GraduatedWeights graduation({1000.0, 500.0});
  const std::vector<double> weights = graduation.next({1000.0, 500.0});
  // mu = 1 / 1999: weights sqrt(mu (mu + 1) / q) - mu are small and of one size.
  EXPECT_GT(weights[0], 1e-5);
  EXPECT_LT(weights[1] / weights[0], 10.0);
  EXPECT_FALSE(graduation.areBinary());
}

TEST(GraduatedWeights, AreAllOneWhereNothingContradicts) {
  GraduatedWeights graduation({0.1, 0.2});
  EXPECT_EQ(graduation.next({0.1, 0.2}), (std::vector<double>{1, 1}));
  EXPECT_TRUE(graduation.areBinary());
}

/// Size of the largest clique by trying all sets.
size_t largestByTrial(const AdjacencyMatrix& graph) {
  size_t best = 0;
  for (uint32_t set = 0; set < (1U << graph.size()); ++set) {
    bool is_clique = true;
    for (size_t a = 0; a < graph.size() && is_clique; ++a) {
      for (size_t b = 0; b < a && is_clique; ++b) {
        is_clique = !((set >> a) & (set >> b) & 1U) || graph.areConnected(a, b);
      }
    }
    if (is_clique) best = std::max(best, static_cast<size_t>(std::popcount(set)));
  }
  return best;
}

TEST(MaximumClique, IsAsLargeAsTheBestOfAllSets) {
  std::mt19937_64 generator(5);
  for (int trial = 0; trial < 30; ++trial) {
    AdjacencyMatrix graph(12);
    for (size_t a = 0; a < 12; ++a) {
      for (size_t b = 0; b < a; ++b) {
        if (generator() % 100 < 20U + 2U * static_cast<unsigned>(trial)) graph.connect(a, b);
      }
    }
    const Clique clique = maximumClique(graph);
    EXPECT_TRUE(clique.is_largest);
    EXPECT_EQ(clique.vertices.size(), largestByTrial(graph));
    for (const size_t a : clique.vertices) {
      for (const size_t b : clique.vertices) EXPECT_TRUE(a == b || graph.areConnected(a, b));
    }
  }
}

TEST(MaximumClique, FindsAPlantedCliqueOf60Among300) {
  std::mt19937_64 generator(6);
  AdjacencyMatrix graph(300);
  for (size_t a = 0; a < 300; ++a) {
    for (size_t b = 0; b < a; ++b) {
      const bool is_planted = a % 5 == 0 && b % 5 == 0;
      if (is_planted || generator() % 100 < 10) graph.connect(a, b);
    }
  }
  const Clique clique = maximumClique(graph);
  EXPECT_TRUE(clique.is_largest);
  ASSERT_EQ(clique.vertices.size(), 60U);
  for (size_t i = 0; i < 60; ++i) EXPECT_EQ(clique.vertices[i], 5 * i);
}

TEST(MaximumClique, SaysWhenItsStepsRanOut) {
  std::mt19937_64 generator(7);
  AdjacencyMatrix graph(200);
  for (size_t a = 0; a < 200; ++a) {
    for (size_t b = 0; b < a; ++b) {
      if (generator() % 2 == 0) graph.connect(a, b);
    }
  }
  const Clique clique = maximumClique(graph, 50);
  EXPECT_FALSE(clique.is_largest);
  EXPECT_GE(clique.vertices.size(), 2U);
}

TEST(MaximumClique, HandlesGraphsWithoutEdgesOrVertices) {
  EXPECT_TRUE(maximumClique(AdjacencyMatrix(0)).vertices.empty());
  EXPECT_EQ(maximumClique(AdjacencyMatrix(70)).vertices.size(), 1U);
  EXPECT_THROW(AdjacencyMatrix(3).connect(0, 3), InputError);
}

/// Two dives of one circuit with the chains of their odometry.
class TwoDives : public testing::Test {
 protected:
  TwoDives() {
    dives_[0] = swumCircuit({.keyframes = 120}, &generator_);
    dives_[1] = swumCircuit({.keyframes = 120, .dive = 1, .first_id = 1000, .first_place = 30}, &generator_);
    for (int d = 0; d < 2; ++d) {
      const auto& keyframes = dives_[d].keyframes;
      chains_[d].start(keyframes[0].id, keyframes[0].odom_from_body);
      for (size_t k = 1; k < keyframes.size(); ++k) {
        chains_[d].extend(keyframes[k].id, odometryEdge(keyframes[k - 1], keyframes[k]));
      }
    }
  }
  OdometryBetween odometry() const {
    return [this](KeyframeId a, KeyframeId b) { return chains_[a < 1000 ? 0 : 1].relative(a, b); };
  }
  /// A true loop at place k of the second dive, where the first dive has been before.
  Loop truth(size_t k) {
    return trueLoop(static_cast<KeyframeId>(k) + 30, dives_[0].truth[k + 30],
                    1000 + static_cast<KeyframeId>(k), dives_[1].truth[k], &generator_);
  }

  std::mt19937_64 generator_{11};
  CircuitDive dives_[2];
  OdometryChain chains_[2];
};

TEST_F(TwoDives, TrueLoopsHaveChiSquaredOfSixDegreesOfFreedom) {
  double sum = 0.0;
  int count = 0;
  for (size_t k = 0; k < 80; k += 4) {
    const double chi_squared = circuitOf(truth(k), truth(k + 6), odometry()).chiSquared();
    sum += chi_squared;
    ++count;
  }
  // The floor of odometry makes the covariance larger than it is, so the mean lies below 6.
  EXPECT_GT(sum / count, 2.0);
  EXPECT_LT(sum / count, 9.0);
}

TEST_F(TwoDives, FalseLoopsAreLeftOutOfTheLargestSet) {
  std::vector<Loop> loops;
  for (size_t k = 0; k < 84; k += 3) loops.push_back(truth(k));
  const size_t true_loops = loops.size();
  std::uniform_int_distribution<KeyframeId> any(0, 119);
  for (int k = 0; k < 12; ++k)
    loops.push_back(falseLoop(any(generator_), 1000 + any(generator_), &generator_));
  const ConsistentLoops found = largestConsistentSet(loops, odometry());
  EXPECT_TRUE(found.is_largest);
  EXPECT_GE(found.indices.size(), true_loops * 9 / 10);
  for (const size_t index : found.indices) EXPECT_LT(index, true_loops);
}

TEST_F(TwoDives, BrokenLoopsAreErrors) {
  Loop loop = truth(0);
  loop.covariance.setZero();
  EXPECT_THROW(largestConsistentSet({loop}, odometry()), InputError);
  EXPECT_TRUE(largestConsistentSet({}, odometry()).indices.empty());
  EXPECT_THROW(largestConsistentSet({}, odometry(), {.probability = 0.0}), UsageError);
}

}  // namespace
}  // namespace lodeline

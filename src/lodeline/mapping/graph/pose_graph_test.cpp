#include "lodeline/mapping/graph/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/keyframe_factors.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"
#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {
namespace {

using testing::HasSubstr;

std::vector<Rigid3> posesOf(const PoseGraph& graph) {
  std::vector<Rigid3> poses;
  for (const auto& [id, pose] : graph.poses()) poses.push_back(pose);
  return poses;
}

/// True loops from the second round of a circuit to the first one.
std::vector<Loop> trueLoops(const CircuitDive& dive, size_t step, std::mt19937_64* generator) {
  std::vector<Loop> loops;
  for (size_t k = 0; k + 150 < dive.truth.size(); k += step) {
    const auto id = static_cast<KeyframeId>(k);
    loops.push_back(trueLoop(id, dive.truth[k], id + 150, dive.truth[k + 150], generator));
  }
  return loops;
}

double distance_m(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0.0;
  for (const auto& [id, pose] : a.poses()) {
    largest = std::max(largest, (pose.translation - b.pose(id).translation).norm());
  }
  return largest;
}

TEST(PoseGraph, TrueLoopsRemoveMostOfTheDrift) {
  double before_m = 0.0, after_m = 0.0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 generator(seed);
    const CircuitDive dive = swumCircuit({.position_m_per_sqrt_m = 0.004}, &generator);
    PoseGraph graph = graphOf(dive);
    graph.solve();
    before_m += alignedRmse_m(posesOf(graph), dive.truth);
    for (const Loop& loop : trueLoops(dive, 25, &generator)) graph.add(edgeOf(loop));
    const GraphSummary summary = graph.solve();
    EXPECT_EQ(summary.acceptedLoops(), 6);
    after_m += alignedRmse_m(posesOf(graph), dive.truth);
  }
  EXPECT_LE(after_m, 0.4 * before_m) << before_m / 5 << " m before";
}

TEST(PoseGraph, AWrongLoopIsRefusedWithItsReasonAndChangesNothing) {
  std::mt19937_64 generator(3);
  const CircuitDive dive = swumCircuit({}, &generator);
  PoseGraph without = graphOf(dive), with = graphOf(dive);
  for (const Loop& loop : trueLoops(dive, 25, &generator)) {
    without.add(edgeOf(loop));
    with.add(edgeOf(loop));
  }
  without.solve();
  with.add(edgeOf(falseLoop(20, 90, &generator)));
  const GraphSummary summary = with.solve();
  EXPECT_EQ(summary.acceptedLoops(), 6);
  ASSERT_EQ(summary.refusedLoops(), 1);
  const FactorReport& refused = summary.factors.back();
  EXPECT_FALSE(refused.accepted);
  EXPECT_EQ(refused.weight, 0.0);
  EXPECT_GT(refused.chi_squared, 20.0);
  EXPECT_THAT(refused.reason, HasSubstr("contradicts the rest of the graph: chi^2"));
  EXPECT_LT(distance_m(with, without), 1e-6);
  // The factor is not in the normal matrix either.
  const Mat6 a = with.covariance().of(250), b = without.covariance().of(250);
  EXPECT_LT((a - b).norm(), 1e-6 * b.norm());
}

TEST(PoseGraph, RefusesASingleLoopThatOdometryContradicts) {
  std::mt19937_64 generator(4);
  const CircuitDive dive = swumCircuit({.keyframes = 150}, &generator);
  PoseGraph graph = graphOf(dive);
  graph.add(edgeOf(falseLoop(10, 80, &generator)));
  EXPECT_EQ(graph.solve().refusedLoops(), 1);
}

TEST(PoseGraph, RefusesRunsOfFalseLoopsThatAgreeWithEachOther) {
  std::mt19937_64 generator(5);
  const CircuitDive dive = swumCircuit({}, &generator);
  PoseGraph graph = graphOf(dive);
  const std::vector<Loop> loops = trueLoops(dive, 5, &generator);
  for (int run = 0; run < 6; ++run) {
    const Rigid3 first = falseLoop(0, 1, &generator).old_from_new;
    for (KeyframeId k = 0; k < 5; ++k) {
      const auto from = static_cast<size_t>(15 * run + k), to = static_cast<size_t>(250 - 20 * run + k);
      const Rigid3 relative =
          (dive.truth[from - static_cast<size_t>(k)].inverse() * dive.truth[from]).inverse() * first *
          dive.truth[to - static_cast<size_t>(k)].inverse() * dive.truth[to];
      graph.add({static_cast<KeyframeId>(from), static_cast<KeyframeId>(to),
                 withError({relative, loopCovariance()}, &generator), true});
    }
  }
  for (const Loop& loop : loops) graph.add(edgeOf(loop));
  const GraphSummary summary = graph.solve();
  ASSERT_EQ(summary.factors.size(), 30 + loops.size());
  int true_accepted = 0;
  for (size_t i = 0; i < summary.factors.size(); ++i) {
    if (i < 30) {
      EXPECT_FALSE(summary.factors[i].accepted) << i;
    } else {
      true_accepted += summary.factors[i].accepted ? 1 : 0;
    }
  }
  EXPECT_GE(true_accepted, 0.95 * static_cast<double>(loops.size()));
  EXPECT_LT(alignedRmse_m(posesOf(graph), dive.truth), 1.0);
}

TEST(PoseGraph, LoopsOneByOneEndAtTheSolutionOfAllAtOnce) {
  std::mt19937_64 generator(6);
  const CircuitDive dive = swumCircuit({}, &generator);
  std::vector<Loop> loops = trueLoops(dive, 10, &generator);
  loops.insert(loops.begin() + 4, falseLoop(30, 110, &generator));
  loops.insert(loops.begin() + 9, falseLoop(5, 77, &generator));
  PoseGraph one_by_one = graphOf(dive), at_once = graphOf(dive);
  GraphSummary last;
  for (const Loop& loop : loops) {
    one_by_one.add(edgeOf(loop));
    last = one_by_one.solve();
  }
  for (const Loop& loop : loops) at_once.add(edgeOf(loop));
  const GraphSummary all = at_once.solve();
  for (size_t i = 0; i < loops.size(); ++i) {
    EXPECT_EQ(last.factors[i].accepted, i != 4 && i != 9) << i;
    EXPECT_EQ(all.factors[i].accepted, i != 4 && i != 9) << i;
  }
  EXPECT_LT(distance_m(one_by_one, at_once), 1e-3);
}

TEST(PoseGraph, TheSameInputGivesTheSameBytes) {
  const auto solved = [] {
    std::mt19937_64 generator(7);
    const CircuitDive dive = swumCircuit({}, &generator);
    PoseGraph graph = graphOf(dive);
    for (const Loop& loop : trueLoops(dive, 20, &generator)) graph.add(edgeOf(loop));
    graph.add(edgeOf(falseLoop(30, 120, &generator)));
    graph.solve();
    return posesOf(graph);
  };
  const std::vector<Rigid3> a = solved(), b = solved();
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].translation, b[i].translation);
    EXPECT_EQ(a[i].rotation.coeffs(), b[i].rotation.coeffs());
  }
}

/// A chain of nodes 0 to `last` on the circuit with edges that have errors, and a loop back to node 0.
struct Ring {
  std::vector<Rigid3> truth;
  std::vector<GraphEdge> edges;

  Ring(size_t last, std::mt19937_64* generator)
      : truth(swumCircuit({.keyframes = static_cast<int>(last) + 1}, generator).truth) {
    for (size_t k = 0; k < last; ++k) addEdge(k, k + 1, false, generator);
    addEdge(0, last, true, generator);
  }
  PoseGraph graph() const {
    PoseGraph result;
    for (size_t k = 0; k < truth.size(); ++k) result.addNode(static_cast<KeyframeId>(k), 0, truth[k]);
    for (const GraphEdge& edge : edges) result.add(edge);
    return result;
  }

 private:
  void addEdge(size_t from, size_t to, bool robust, std::mt19937_64* generator) {
    const RelativePose relative{truth[from].inverse() * truth[to], loopCovariance()};
    edges.push_back(
        {static_cast<KeyframeId>(from), static_cast<KeyframeId>(to), withError(relative, generator), robust});
  }
};

TEST(PoseGraph, CovariancesAreThoseOfADenseInverse) {
  std::mt19937_64 generator(8);
  const Ring ring(4, &generator);
  PoseGraph graph = ring.graph();
  graph.solve();
  std::map<KeyframeId, Rigid3> poses = graph.poses();
  const Mat6 whitening = Eigen::LLT<Mat6>(loopCovariance()).matrixL().solve(Mat6::Identity());
  const auto residuals = [&](const std::map<KeyframeId, Rigid3>& at) {
    Eigen::VectorXd all(6 * static_cast<Eigen::Index>(ring.edges.size()));
    for (size_t i = 0; i < ring.edges.size(); ++i) {
      const GraphEdge& edge = ring.edges[i];
      all.segment<6>(6 * static_cast<Eigen::Index>(i)) =
          whitening * errorBetween(edge.relative.from_from_to, at.at(edge.from).inverse() * at.at(edge.to));
    }
    return all;
  };
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd jacobian(6 * static_cast<Eigen::Index>(ring.edges.size()), 24);
  for (int column = 0; column < 24; ++column) {
    const auto moved = [&](double step) {
      std::map<KeyframeId, Rigid3> at = poses;
      Rigid3& pose = at.at(1 + column / 6);
      const int axis = column % 6;
      if (axis < 3) pose.translation[axis] += step;
      if (axis >= 3) {
        const Eigen::AngleAxisd turn(step, Vec3::Unit(axis - 3));
        pose.rotation = (Quat(turn) * pose.rotation).normalized();
      }
      return residuals(at);
    };
    jacobian.col(column) = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
  }
  const Eigen::MatrixXd dense = (jacobian.transpose() * jacobian).inverse();
  const Eigen::MatrixXd sparse = graph.covariance().joint({1, 2, 3, 4});
  EXPECT_LT((sparse - dense).cwiseAbs().maxCoeff(), 1e-5 * dense.cwiseAbs().maxCoeff());
  EXPECT_EQ(graph.covariance().of(0), Mat6::Zero());
  EXPECT_THROW(graph.covariance().of(9), InputError);
}

TEST(PoseGraph, ErrorsOfSolutionsAreThoseThatTheCovarianceClaims) {
  double sum = 0.0;
  constexpr int kTrials = 60;
  for (uint64_t seed = 1; seed <= kTrials; ++seed) {
    std::mt19937_64 generator(seed);
    const Ring ring(40, &generator);
    PoseGraph graph = ring.graph();
    graph.solve();
    const Mat6 covariance = graph.covariance().of(20);
    sum += mahalanobisSquared(graph.pose(20), ring.truth[20], covariance);
  }
  // The sum of chi^2 of 60 draws has 360 degrees of freedom.
  EXPECT_GT(sum, chiSquaredQuantile(0.005, 6 * kTrials));
  EXPECT_LT(sum, chiSquaredQuantile(0.995, 6 * kTrials));
}

TEST(PoseGraph, SolvesGraphsWithoutLoopsAndPartsThatNothingConnects) {
  EXPECT_TRUE(PoseGraph().solve().converged);
  std::mt19937_64 generator(9);
  const CircuitDive first = swumCircuit({.keyframes = 30}, &generator);
  PoseGraph one;
  addKeyframe(first.keyframes[0], nullptr, &one);
  EXPECT_TRUE(one.solve().converged);
  EXPECT_LT((one.pose(0).translation - first.keyframes[0].odom_from_body.translation).norm(), 1e-9);

  const CircuitDive second = swumCircuit({.keyframes = 30, .dive = 1, .first_id = 1000}, &generator);
  PoseGraph graph = graphOf(first);
  for (size_t k = 0; k < 30; ++k) {
    addKeyframe(second.keyframes[k], k > 0 ? &second.keyframes[k - 1] : nullptr, &graph);
  }
  const GraphSummary summary = graph.solve();
  EXPECT_TRUE(summary.converged);
  EXPECT_TRUE(summary.factors.empty());
  EXPECT_GT(graph.covariance().of(1010)(0, 0), 1e5);  // weak prior of 1 km
}

TEST(PoseGraph, LoopsJoinDivesThatNothingElseConnects) {
  std::mt19937_64 generator(10);
  const CircuitDive first = swumCircuit({.keyframes = 120}, &generator);
  const CircuitDive second =
      swumCircuit({.keyframes = 90, .dive = 1, .first_id = 1000, .first_place = 20}, &generator);
  PoseGraph graph = graphOf(first);
  for (size_t k = 0; k < 90; ++k) {
    addKeyframe(second.keyframes[k], k > 0 ? &second.keyframes[k - 1] : nullptr, &graph);
  }
  graph.add(edgeOf(falseLoop(90, 1010, &generator)));
  for (size_t k = 0; k < 80; k += 8) {
    const auto id = static_cast<KeyframeId>(k);
    graph.add(edgeOf(trueLoop(id + 20, first.truth[k + 20], 1000 + id, second.truth[k], &generator)));
  }
  const GraphSummary summary = graph.solve();
  EXPECT_FALSE(summary.factors[0].accepted);
  EXPECT_EQ(summary.acceptedLoops(), 10);
  EXPECT_LT((graph.pose(20).translation - graph.pose(1000).translation).norm(), 0.2);
}

TEST(PoseGraph, RefusesBrokenInput) {
  std::mt19937_64 generator(11);
  const CircuitDive dive = swumCircuit({.keyframes = 3}, &generator);
  PoseGraph graph = graphOf(dive);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GraphEdge edge = edgeOf(trueLoop(0, dive.truth[0], 2, dive.truth[2], &generator));
  edge.relative.from_from_to.translation.x() = nan;
  EXPECT_THROW(graph.add(edge), InputError);
  edge = edgeOf(trueLoop(0, dive.truth[0], 2, dive.truth[2], &generator));
  edge.relative.covariance(0, 0) = nan;
  EXPECT_THROW(graph.add(edge), InputError);
  edge.relative.covariance = -Mat6::Identity();
  EXPECT_THROW(graph.add(edge), InputError);
  edge.relative.covariance = Mat6::Identity();
  edge.to = 77;
  EXPECT_THROW(graph.add(edge), InputError);
  edge.to = edge.from;
  EXPECT_THROW(graph.add(edge), InputError);
  EXPECT_THROW(graph.addNode(1, 0, Rigid3{}), InputError);
  MapKeyframe keyframe = dive.keyframes[2];
  keyframe.id = 3;
  keyframe.covariance(0, 0) = nan;
  EXPECT_THROW(addKeyframe(keyframe, &dive.keyframes[2], &graph), InputError);
  // Nothing of it is in the graph.
  const GraphSummary summary = graph.solve();
  EXPECT_TRUE(summary.converged);
  EXPECT_TRUE(summary.factors.empty());
  EXPECT_EQ(graph.size(), 3U);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/problem/normal_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// Largest deviation relative to the diagonal, which makes it independent of units.
double deviation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseAbs().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

class NormalEquationsTest : public testing::Test {
 protected:
  NormalEquationsTest() {
    prior_ = test_.fill();
    test_.disturb(0.01, 3);
    // Some blocks have a linearization point that differs from their value, as after marginalization.
    Frame& second = *test_.window.frames()[1];
    second.first_pose = second.pose;
    (*second.first_pose)[0] += 0.02;
  }

  // Rows of `system` in the order of `dense`.
  std::vector<int> rowsOf(const NormalEquations& system, const DenseSystem& dense, int rows) const {
    std::vector<int> order(rows, -1);
    for (const NormalEquations::Block& block : system.blocks()) {
      for (int i = 0; i < block.tangentSize(); ++i) order[dense.offsetOf(block.value) + i] = block.offset + i;
    }
    return order;
  }

  void addFrameTerms(NormalEquations* system) {
    system->add(test_.factors.prior(prior_));
    const auto& frames = test_.window.frames();
    for (size_t k = 1; k < frames.size(); ++k)
      system->add(test_.factors.inertial(test_.window, *frames[k - 1], *frames[k]));
  }

  TestWindow test_;
  Prior prior_;
};

TEST_F(NormalEquationsTest, EqualTheDenseGaussNewtonSystem) {
  const DenseSystem dense = denseSystem(test_.window, prior_, test_.factors);
  NormalEquations system;
  addFrameTerms(&system);
  for (auto& [id, track] : test_.window.tracks()) {
    if (!track.landmark) continue;
    for (const Factor& factor : test_.factors.landmark(test_.window, track).factors) system.add(factor);
  }
  ASSERT_EQ(system.size(), dense.hessian.rows());
  ASSERT_GT(system.size(), dense.frame_rows + 60) << "too few landmarks for a test";
  const std::vector<int> order = rowsOf(system, dense, system.size());
  const Eigen::MatrixXd h = system.hessian();
  EXPECT_LT(deviation(h(order, order), dense.hessian), 1e-12);
  EXPECT_LT((system.gradient()(order) - dense.gradient).norm(), 1e-12 * dense.gradient.norm());
  EXPECT_EQ(h, h.transpose());
}

TEST_F(NormalEquationsTest, EliminatedLandmarksEqualTheDenseSchurComplement) {
  const DenseSystem dense = denseSystem(test_.window, prior_, test_.factors);
  const Reduced reduced = denseSchur(dense.hessian, dense.gradient, dense.frame_rows);
  NormalEquations system;
  addFrameTerms(&system);
  for (auto& [id, track] : test_.window.tracks()) {
    if (track.landmark) system.addEliminated(test_.factors.landmark(test_.window, track));
  }
  ASSERT_EQ(system.size(), dense.frame_rows);
  const std::vector<int> order = rowsOf(system, dense, dense.frame_rows);
  const Eigen::MatrixXd h = system.hessian();
  EXPECT_LT(deviation(h(order, order), reduced.hessian), 1e-10);
  EXPECT_LT((system.gradient()(order) - reduced.gradient).norm(), 1e-9 * dense.gradient.norm());
}

// Two views from one position do not determine a point's distance. Their information on the rotation must be
// the same as without the distance among the unknowns. There must be no information on the translation.
TEST(NormalEquations, ALandmarkOfUnknownDistanceGivesRotationOnly) {
  TestWindow test(1);
  const Rigid3 body_from_camera = test.rig.cameras[0].body_from_camera;
  const Rigid3 world_from_camera = Rigid3() * body_from_camera;
  const Rigid3 turned(so3::exp(Vec3(0.0, 0.1, 0.05)) * world_from_camera.rotation,
                      world_from_camera.translation);
  const Frame& host = test.add(Rigid3());
  const Frame& target = test.add(turned * body_from_camera.inverse());
  const Vec3 point_W(4.0, 0.5, 0.2);
  test.see(7, point_W, host);
  test.see(7, point_W, target, 0, Vec2(1.0, -0.5));
  test.place(7, point_W, host);

  NormalEquations system;
  system.addEliminated(test.factors.landmark(test.window, test.window.tracks().at(7)));
  const Eigen::MatrixXd h = system.hessian();
  ASSERT_TRUE(h.allFinite());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(h);
  EXPECT_GT(solver.eigenvalues()[0], -1e-9 * solver.eigenvalues()[11]) << "must stay semi-definite";

  // Reference: the distance is not among the unknowns.
  DenseSystem dense = denseSystem(test.window, {}, test.factors);
  std::vector<int> order;
  for (const Frame* frame : {&host, &target}) {
    for (int i = 0; i < 6; ++i) order.push_back(dense.offsetOf(frame->pose.data()) + i);
  }
  const int landmark = dense.offsetOf(test.window.tracks().at(7).landmark->parameters.data());
  order.insert(order.end(), {landmark, landmark + 1});
  const Eigen::MatrixXd held = dense.hessian(order, order);
  const Eigen::VectorXd held_gradient = dense.gradient(order);
  const Reduced reduced = denseSchur(held, held_gradient, 12);
  std::vector<int> rows;
  for (const Frame* frame : {&host, &target}) {
    for (int i = 0; i < 6; ++i) rows.push_back(system.find(frame->pose.data())->offset + i);
  }
  EXPECT_LT((h(rows, rows) - reduced.hessian).cwiseAbs().maxCoeff(), 1e-8 * h.cwiseAbs().maxCoeff());
  EXPECT_LT((system.gradient()(rows) - reduced.gradient).norm(), 1e-8 * held_gradient.norm());
}

TEST(NormalEquations, TwoViewsOfALandmarkLeaveOneEquation) {
  TestWindow test(2);
  const Frame& host = test.add(Rigid3());
  const Frame& target = test.add(Rigid3(Quat::Identity(), Vec3(0.0, 0.3, 0.0)));
  test.see(1, Vec3(3, 0, 0), host);
  test.see(1, Vec3(3, 0, 0), target);
  test.place(1, Vec3(3, 0, 0), host);
  NormalEquations system;
  system.addEliminated(test.factors.landmark(test.window, test.window.tracks().at(1)));
  const Eigen::MatrixXd h = system.hessian();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(h);
  const double largest = solver.eigenvalues()[11];
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(std::abs(solver.eigenvalues()[10]), 1e-9 * largest) << "4 residuals - 3 unknowns = rank 1";
}

}  // namespace
}  // namespace lodeline

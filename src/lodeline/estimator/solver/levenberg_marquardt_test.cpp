#include "lodeline/estimator/solver/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lodeline {
namespace {

/// Half the sum of squares of residuals r(x) of two unknowns.
class SmallProblem {
 public:
  explicit SmallProblem(const Eigen::Vector2d& start) : values(start) {}
  virtual ~SmallProblem() = default;
  virtual Eigen::VectorXd residuals(const Eigen::Vector2d& x) const = 0;
  virtual Eigen::MatrixXd jacobian(const Eigen::Vector2d& x) const = 0;

  double cost() {
    const double cost = 0.5 * residuals(values).squaredNorm();
    if (!costs.empty() && !(cost < costs.back())) ++rejected;
    if (costs.empty() || cost < costs.back()) costs.push_back(cost);
    return cost;
  }
  void linearize() {
    before_ = values;
    const Eigen::MatrixXd j = jacobian(values);
    hessian_ = j.transpose() * j;
    gradient_ = j.transpose() * residuals(values);
  }
  bool step(double damping) {
    dampings.push_back(damping);
    Eigen::Matrix2d damped = hessian_;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::LLT<Eigen::Matrix2d> cholesky(damped);
    if (cholesky.info() != Eigen::Success) return false;
    values -= cholesky.solve(gradient_);
    return true;
  }
  void restore() { values = before_; }

  Eigen::Vector2d values;
  std::vector<double> costs, dampings;
  int rejected = 0;

 private:
  Eigen::Vector2d before_, gradient_;
  Eigen::Matrix2d hessian_;
};

class Linear : public SmallProblem {
 public:
  Linear() : SmallProblem({7.0, -3.0}) {}
  Eigen::VectorXd residuals(const Eigen::Vector2d& x) const override {
    return Eigen::Vector3d(x[0] - 1.0, 2.0 * x[1] - 4.0, x[0] + x[1] - 3.0);
  }
  Eigen::MatrixXd jacobian(const Eigen::Vector2d&) const override {
    return (Eigen::MatrixXd(3, 2) << 1.0, 0.0, 0.0, 2.0, 1.0, 1.0).finished();
  }
};

/// Rosenbrock's valley: full steps from the start overshoot.
class Valley : public SmallProblem {
 public:
  Valley() : SmallProblem({-1.2, 1.0}) {}
  Eigen::VectorXd residuals(const Eigen::Vector2d& x) const override {
    return Eigen::Vector2d(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
  }
  Eigen::MatrixXd jacobian(const Eigen::Vector2d& x) const override {
    return (Eigen::MatrixXd(2, 2) << -20.0 * x[0], 10.0, -1.0, 0.0).finished();
  }
};

/// The second unknown has no effect.
class Singular : public Linear {
 public:
  Eigen::VectorXd residuals(const Eigen::Vector2d& x) const override {
    return Eigen::VectorXd::Constant(1, x[0] * x[0] - 4.0);
  }
  Eigen::MatrixXd jacobian(const Eigen::Vector2d& x) const override {
    return (Eigen::MatrixXd(1, 2) << 2.0 * x[0], 0.0).finished();
  }
};

class NotANumber : public Linear {
 public:
  Eigen::VectorXd residuals(const Eigen::Vector2d&) const override {
    return Eigen::VectorXd::Constant(3, std::numeric_limits<double>::quiet_NaN());
  }
};

TEST(LevenbergMarquardt, SolvesALinearProblemInOneUndampedStep) {
  Linear problem;
  const SolveSummary summary = minimize(problem, {10, 1e-12});
  EXPECT_NEAR((problem.values - Eigen::Vector2d(1.0, 2.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(problem.dampings.front(), 0.0);
  EXPECT_TRUE(summary.converged && summary.usable);
  EXPECT_LE(summary.iterations, 2);
  EXPECT_NEAR(summary.final_cost, 0.0, 1e-20);
}

TEST(LevenbergMarquardt, FollowsACurvedValleyAndNeverRaisesTheCost) {
  Valley problem;
  const SolveSummary summary = minimize(problem, {100, 1e-12});
  EXPECT_TRUE(summary.converged);
  EXPECT_NEAR((problem.values - Eigen::Vector2d(1.0, 1.0)).norm(), 0.0, 1e-6);
  EXPECT_GT(problem.rejected, 0);  // or the valley would test nothing
  EXPECT_LE(summary.final_cost, summary.initial_cost);
  EXPECT_NEAR(summary.final_cost, 0.5 * problem.residuals(problem.values).squaredNorm(), 1e-12);
}

TEST(LevenbergMarquardt, LeavesTheValuesWhereNoDampingHelps) {
  Linear problem;
  problem.values = {1.0, 2.0};  // the minimum
  const SolveSummary summary = minimize(problem, {10, 1e-12});
  EXPECT_EQ(problem.values, Eigen::Vector2d(1.0, 2.0));
  EXPECT_TRUE(summary.converged);
  EXPECT_EQ(summary.iterations, 1);
}

TEST(LevenbergMarquardt, EndsAtItsLimitWithoutClaimingConvergence) {
  Valley problem;
  const SolveSummary summary = minimize(problem, {3, 1e-12});
  EXPECT_EQ(summary.iterations, 3);
  EXPECT_FALSE(summary.converged);
}

TEST(LevenbergMarquardt, EndsAtAnAbsoluteGain) {
  Valley rough, fine;
  const SolveSummary early = minimize(rough, {100, 0.0, 1.0});
  const SolveSummary late = minimize(fine, {100, 0.0, 1e-9});
  EXPECT_TRUE(early.converged && late.converged);
  EXPECT_LT(early.iterations, late.iterations);
}

TEST(LevenbergMarquardt, LeavesTheValuesWhereTheHessianIsSingular) {
  Singular problem;
  const SolveSummary summary = minimize(problem, {20, 1e-12});
  EXPECT_EQ(problem.values, Eigen::Vector2d(7.0, -3.0));
  EXPECT_TRUE(summary.usable);
}

TEST(LevenbergMarquardt, ReportsACostThatIsNotANumber) {
  NotANumber problem;
  const Eigen::Vector2d before = problem.values;
  const SolveSummary summary = minimize(problem, {10, 1e-12});
  EXPECT_FALSE(summary.usable);
  EXPECT_EQ(problem.values, before);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/magnetometer/calibration/heading/inertial_residuals.h"

#include <gtest/gtest.h>

#include <functional>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/magnetometer/calibration/heading/bordered_chain.h"

namespace lodeline {
namespace {

using namespace inertial_parameter;
using Step = Eigen::Matrix<double, kSize, 1>;

InertialParameters example() {
  InertialParameters p;
  p.soft_iron << 1.1, 0.05, -0.02, 0.05, 0.9, 0.03, -0.02, 0.03, 1.05;
  p.hard_iron = Vec3(0.1, 0.4, -0.2);
  p.body_from_magnetometer = so3::exp(Vec3(0.5, -1.0, 0.2));
  p.dip_rad = 1.0;
  p.accelerometer_bias_B = Vec3(0.1, 0.2, -0.1);
  return p;
}

const Quat kWorldFromBody = so3::exp(Vec3(0.3, 0.8, -0.5));
const Mat3 kMeanTurn = 0.99 * so3::exp(Vec3(0.01, 0.02, -0.01)).toRotationMatrix();

Vec3 numeric(const std::function<Vec3(double)>& value) { return (value(1e-6) - value(-1e-6)) / 2e-6; }

TEST(FieldResidual, IsZeroAtTheTruth) {
  const InertialParameters p = example();
  const Vec3 reading = p.hard_iron + p.soft_iron * (p.body_from_magnetometer.conjugate() *
                                                    (kWorldFromBody.conjugate() * p.field_W()));
  EXPECT_LT(fieldResidual(reading, Mat3::Identity(), Vec3::Zero(), kWorldFromBody, p).value.norm(), 1e-15);
}

TEST(FieldResidual, JacobiansAgreeWithDifferences) {
  const InertialParameters p = example();
  const Vec3 reading(0.3, -0.7, 0.9), rate_B(0.5, -0.2, 1.0);
  const InertialResidual r = fieldResidual(reading, kMeanTurn, rate_B, kWorldFromBody, p);
  const auto value = [&](const Quat& q, const InertialParameters& at) {
    return fieldResidual(reading, kMeanTurn, rate_B, q, at).value;
  };
  for (int i = 0; i < 3; ++i) {
    const Vec3 by_rotation =
        numeric([&](double d) { return value(kWorldFromBody * so3::exp(d * Vec3::Unit(i)), p); });
    EXPECT_LT((r.by_rotation.col(i) - by_rotation).norm(), 1e-8);
  }
  for (int i = 0; i < kSize; ++i) {
    if (i == kTimeOffset) continue;
    const Vec3 by_parameter =
        numeric([&](double d) { return value(kWorldFromBody, moved(p, d * Step::Unit(i))); });
    EXPECT_LT((r.by_parameters.col(i) - by_parameter).norm(), 1e-8) << i;
  }
  // At a later measurement, the body has rotated further: C -> exp(-rate dt) C.
  const Vec3 by_time = numeric([&](double d) {
    const Mat3 turned = so3::exp(-d * rate_B).toRotationMatrix() * kMeanTurn;
    return fieldResidual(reading, turned, rate_B, kWorldFromBody, p).value;
  });
  EXPECT_LT((r.by_parameters.col(kTimeOffset) - by_time).norm(), 1e-8);
}

TEST(GravityResidual, IsZeroAtRestAndItsJacobiansAgreeWithDifferences) {
  const InertialParameters p = example();
  const Vec3 still = kWorldFromBody.conjugate() * -standardGravity_W() + p.accelerometer_bias_B;
  EXPECT_LT(gravityResidual(still, kWorldFromBody, p).value.norm(), 1e-14);
  const InertialResidual r = gravityResidual(Vec3(1, 2, 3), kWorldFromBody, p);
  for (int i = 0; i < 3; ++i) {
    const Vec3 by_rotation = numeric([&](double d) {
      return gravityResidual(Vec3(1, 2, 3), kWorldFromBody * so3::exp(d * Vec3::Unit(i)), p).value;
    });
    EXPECT_LT((r.by_rotation.col(i) - by_rotation).norm(), 1e-7);
    EXPECT_EQ(r.by_parameters.col(kAccelerometerBias + i), -Vec3::Unit(i));
  }
}

TEST(TurnResidual, JacobiansAgreeWithDifferences) {
  const Quat turn = so3::exp(Vec3(0.02, -0.05, 0.03)),
             second = kWorldFromBody * so3::exp(Vec3(0.1, 0.2, 0.3));
  const Mat3 by_bias = -0.02 * so3::exp(Vec3(0.1, 0.0, 0.2)).toRotationMatrix();
  const TurnResidual r = turnResidual(turn, by_bias, kWorldFromBody, second);
  const auto value = [&](const Quat& t, const Quat& a, const Quat& b) {
    return turnResidual(t, by_bias, a, b).value;
  };
  EXPECT_LT(value(kWorldFromBody.conjugate() * second, kWorldFromBody, second).norm(), 1e-15);
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = Vec3::Unit(i);
    const Vec3 first =
        numeric([&](double d) { return value(turn, kWorldFromBody * so3::exp(d * axis), second); });
    const Vec3 other =
        numeric([&](double d) { return value(turn, kWorldFromBody, second * so3::exp(d * axis)); });
    const Vec3 bias =
        numeric([&](double d) { return value(turn * so3::exp(d * by_bias * axis), kWorldFromBody, second); });
    EXPECT_LT((r.by_first.col(i) - first).norm(), 1e-8);
    EXPECT_LT((r.by_second.col(i) - other).norm(), 1e-8);
    EXPECT_LT((r.by_bias.col(i) - bias).norm(), 1e-8);
  }
}

// Compares the chain's elimination with the dense equations.
TEST(BorderedChain, SolvesWhatTheDenseEquationsSolve) {
  constexpr int kStates = 6, kParameters = 2, kAll = 3 * kStates + kParameters;
  using Chain = BorderedChain<kParameters>;
  Chain chain(kStates);
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(kAll, kAll);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(kAll);
  std::srand(7);
  const auto dense = [&](const Eigen::MatrixXd& j, const Vec3& r) {
    h += j.transpose() * j;
    g += j.transpose() * r;
  };
  for (int k = 0; k < kStates; ++k) {
    const Vec3 r = Vec3::Random();
    const Mat3 a = Mat3::Random(), b = Mat3::Random();
    const Chain::Border p = Chain::Border::Random();
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(3, kAll);
    j.block<3, 3>(0, 3 * k) = a;
    j.rightCols<kParameters>() = p;
    chain.addUnary(static_cast<size_t>(k), r, a, p);
    dense(j, r);
    if (k + 1 == kStates) break;
    j.block<3, 3>(0, 3 * k + 3) = b;
    chain.addBinary(static_cast<size_t>(k), r, a, b, p);
    dense(j, r);
  }
  chain.addPrior(1, 0.3, 2.0);
  h(kAll - 1, kAll - 1) += 0.25;
  g[kAll - 1] += 0.075;

  const Eigen::VectorXd solution = h.ldlt().solve(-g);
  const Chain::Marginal marginal = chain.eliminate();
  const Chain::Parameters p = marginal.information.ldlt().solve(-marginal.gradient);
  EXPECT_LT((p - solution.tail<kParameters>()).norm(), 1e-9);
  const std::vector<Vec3> states = chain.statesFor(p);
  for (int k = 0; k < kStates; ++k) {
    EXPECT_LT((states[static_cast<size_t>(k)] - solution.segment<3>(3 * k)).norm(), 1e-9);
  }
  const Eigen::MatrixXd inner = h.topLeftCorner<3 * kStates, 3 * kStates>();
  EXPECT_NEAR(marginal.log_determinant, std::log(inner.determinant()), 1e-9);
  EXPECT_NEAR(marginal.reduction, 0.5 * g.head<3 * kStates>().dot(inner.ldlt().solve(g.head<3 * kStates>())),
              1e-9);
}

}  // namespace
}  // namespace lodeline

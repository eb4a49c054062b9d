#include "lodeline/geometry/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {
namespace {

// Angles on both sides of every series switch, and close to pi.
const std::vector<double> kAngles = {0.0, 1e-9, 1e-5, 9.9e-4, 1.01e-3, 2.1e-3, 0.1, 1.0, 3.0, 3.141};
const Vec3 kAxis = Vec3(0.3, -0.8, 0.5).normalized();

TEST(So3, LogInvertsExp) {
  for (const double angle : kAngles) {
    const Vec3 v = angle * kAxis;
    EXPECT_LT((so3::log(so3::exp(v)) - v).norm(), 1e-13 + 1e-12 * angle) << angle;
  }
}

TEST(So3, ExpAgreesWithEigenAngleAxis) {
  for (const double angle : kAngles) {
    const Mat3 expected = Eigen::AngleAxisd(angle, kAxis).toRotationMatrix();
    EXPECT_LT((so3::exp(angle * kAxis).toRotationMatrix() - expected).norm(), 1e-14) << angle;
  }
}

TEST(So3, RightJacobianIsTheDerivativeOfExp) {
  constexpr double kStep = 1e-6;
  for (const double angle : kAngles) {
    const Vec3 v = angle * kAxis;
    Mat3 numeric;
    for (int i = 0; i < 3; ++i) {
      const Vec3 step = kStep * Vec3::Unit(i);
      numeric.col(i) = so3::log(so3::exp(v - step).conjugate() * so3::exp(v + step)) / (2.0 * kStep);
    }
    EXPECT_LT((so3::rightJacobian(v) - numeric).norm(), 1e-8) << angle;
    EXPECT_LT((so3::rightJacobian(v) * so3::rightJacobianInverse(v) - Mat3::Identity()).norm(), 1e-12)
        << angle;
  }
}

TEST(So3, CanonicalHasPositiveScalarPart) {
  const Quat q = so3::canonical(Quat(-0.5, 0.5, 0.5, 0.5));
  EXPECT_DOUBLE_EQ(q.w(), 0.5);
}

TEST(TangentBasis, IsOrthonormalToTheDirectionEverywhere) {
  for (const Vec3& d :
       {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.36, 0.48, -0.8), Vec3(-0.6, 0, 0.8)}) {
    const Mat32 basis = tangentBasis(d);
    EXPECT_LT((basis.transpose() * basis - Mat2::Identity()).norm(), 1e-14);
    EXPECT_LT((basis.transpose() * d).norm(), 1e-14);
  }
}

TEST(Rigid3, InverseAndCompositionAgreeWithMatrices) {
  const Rigid3 a(so3::exp(Vec3(0.1, 0.2, -0.3)), Vec3(1, 2, 3));
  const Rigid3 b(so3::exp(Vec3(-1.0, 0.4, 0.2)), Vec3(-2, 0.5, 1));
  EXPECT_LT(((a * b).matrix() - a.matrix() * b.matrix()).norm(), 1e-14);
  EXPECT_LT((a.inverse().matrix() - a.matrix().inverse()).norm(), 1e-14);
}

TEST(Rigid3, FromMatrixRefusesWhatIsNoRotation) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix(0, 0) = -1.0;
  EXPECT_THROW(Rigid3::fromMatrix(matrix, "T_BS"), InputError);
  matrix(0, 0) = std::nan("");
  EXPECT_THROW(Rigid3::fromMatrix(matrix, "T_BS"), InputError);
  matrix(0, 0) = 1.0002;
  EXPECT_LT((Rigid3::fromMatrix(matrix, "T_BS").matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-14);
}

}  // namespace
}  // namespace lodeline

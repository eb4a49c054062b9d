#include "lodeline/types.h"

#include <fmt/core.h>

#include <Eigen/SVD>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

Rigid3 Rigid3::fromMatrix(const Eigen::Matrix4d& matrix, const char* what) {
  const Mat3 rotation = matrix.topLeftCorner<3, 3>();
  const double error = (rotation.transpose() * rotation - Mat3::Identity()).norm();
  // Written so that NaN entries fail too.
  if (!(matrix.allFinite() && error < 1e-3 && rotation.determinant() > 0.0)) {
    throw InputError(
        fmt::format("{}: the upper left 3x3 block is not a rotation (R^T R differs from the identity by "
                    "{:.2g}); write the "
                    "transform with at least 5 digits",
                    what, error));
  }
  const Eigen::JacobiSVD<Mat3> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 nearest = svd.matrixU() * svd.matrixV().transpose();
  return Rigid3(so3::canonical(Quat(nearest)), matrix.topRightCorner<3, 1>());
}

Eigen::Matrix4d Rigid3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

}  // namespace lodeline

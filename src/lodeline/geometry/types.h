#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace lodeline {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat2 = Eigen::Matrix2d;
using Mat3 = Eigen::Matrix3d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Mat23 = Eigen::Matrix<double, 2, 3>;
using Mat32 = Eigen::Matrix<double, 3, 2>;
/// Unit quaternion, Hamilton convention.
using Quat = Eigen::Quaterniond;

}  // namespace lodeline

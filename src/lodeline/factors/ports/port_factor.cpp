#include "lodeline/factors/ports/port_factor.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lodeline/cameras/port_camera.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kAside_m = 0.01;  // h
constexpr double kOutlier = 1e4;   // residual of a point without a pixel, sigmas
constexpr double kFarthest_m = 1e7;

using RowMajorBlock = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>;
using PortJacobian = Eigen::Matrix<double, 2, kPortChangeSize, Eigen::RowMajor>;

DirectionMeasurement unweighted(const DirectionMeasurement& measurement, double aside_m) {
  DirectionMeasurement ray = measurement;
  ray.sqrt_information.setIdentity();
  ray.curvature.setZero();
  ray.origin_C = aside_m * measurement.tangent_C.col(0);
  return ray;
}

/// Derivative of the direction in air by the change of a port, from that by the port as changed.
Mat3 byChange(const Port& changed, const DirectionByPort& by_port, const Vec3& change) {
  Mat3 by_change = by_port.leftCols<3>();
  if (changed.type == Port::Type::Dome) return by_change;
  // A turn about the normal has no effect, which gives the derivative by a turn about z.
  const Vec3& normal = changed.normal_C;
  Mat3 by_turn;
  by_turn << by_change.leftCols<2>(), -(by_change.leftCols<2>() * normal.head<2>()) / normal.z();
  by_change.leftCols<2>() = by_turn * so3::leftJacobian(Vec3(change.x(), change.y(), 0.0)).leftCols<2>();
  return by_change;
}

}  // namespace

/// Place of the point beside the measured ray: o and w, and their derivatives by each block that has any.
struct PortFactor::Place {
  Vec2 offset;
  double inverse_depth;
  std::vector<PlaceByBlock> by_blocks;
};

/// Pixel of a point through a changed port, with all derivatives.
struct PortFactor::Projection {
  Vec2 pixel;
  Mat23 by_point;
  PortJacobian by_change;

  static std::optional<Projection> of(const RefractiveCamera& camera, const Vec3& point_C, const Vec3& change,
                                      bool with_derivatives) {
    const Port port = correctedPort(*camera.calibration().port, change);
    if (!portFault(port).empty()) return std::nullopt;
    Mat3 direction_by_point;
    DirectionByPort direction_by_port;
    const auto direction_C =
        makePortRefraction(port)->towards(point_C, with_derivatives ? &direction_by_point : nullptr,
                                          with_derivatives ? &direction_by_port : nullptr);
    if (!direction_C) return std::nullopt;
    Mat23 by_direction;
    const auto pixel = camera.inAir().project(*direction_C, with_derivatives ? &by_direction : nullptr);
    if (!pixel) return std::nullopt;
    Projection projection{*pixel, Mat23::Zero(), PortJacobian::Zero()};
    if (!with_derivatives) return projection;
    projection.by_point = by_direction * direction_by_point;
    projection.by_change = by_direction * byChange(port, direction_by_port, change);
    return projection;
  }
};

DirectionMeasurement throughPort(const RefractiveCamera& camera, const DirectionMeasurement& measurement,
                                 const Vec3& change) {
  const Port port = correctedPort(*camera.calibration().port, change);
  const Vec3 nominal_C = measurement.origin_C + Camera::kNominalDistance_m * measurement.bearing_C;
  const auto pixel = camera.project(nominal_C, nullptr, nullptr);
  if (change.isZero(0.0) || !pixel || !portFault(port).empty()) return measurement;
  const auto in_air_C = camera.inAir().unproject(*pixel);
  const auto line = in_air_C ? makePortRefraction(port)->through(*in_air_C) : std::nullopt;
  if (!line) return measurement;
  const ViewRay ray = line->fromNearestPoint();
  DirectionMeasurement moved = measurement;
  moved.tangent_C =
      Quat::FromTwoVectors(measurement.bearing_C, ray.direction_C).toRotationMatrix() * measurement.tangent_C;
  moved.bearing_C = ray.direction_C;
  moved.origin_C = ray.origin_C;
  return moved;
}

PortFactor::PortFactor(const FactorOf& factor_of, const DirectionMeasurement& measurement,
                       std::shared_ptr<const RefractiveCamera> camera)
    : ahead_(factor_of(unweighted(measurement, 0.0))),
      aside_(factor_of(unweighted(measurement, kAside_m))),
      camera_(std::move(camera)),
      bearing_C_(measurement.bearing_C),
      tangent_C_(measurement.tangent_C) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = ahead_->parameter_block_sizes();
  mutable_parameter_block_sizes()->push_back(kPortChangeSize);
  Mat23 by_point;
  const Vec3 nominal_C = measurement.origin_C + Camera::kNominalDistance_m * bearing_C_;
  const auto pixel = camera_->project(nominal_C, &by_point, nullptr);
  if (!pixel) return;
  pixel_ = *pixel;
  const Mat2 pixel_by_offset = Camera::kNominalDistance_m * by_point * tangent_C_;
  weight_ = measurement.sqrt_information * pixel_by_offset.inverse();
}

bool PortFactor::locate(double const* const* parameters, double** jacobians, Place* place) const {
  const std::vector<int>& sizes = ahead_->parameter_block_sizes();
  std::vector<RowMajorBlock> ahead(sizes.size()), aside(sizes.size());
  std::vector<double*> ahead_to(sizes.size(), nullptr), aside_to(sizes.size(), nullptr);
  for (size_t block = 0; jacobians && block < sizes.size(); ++block) {
    if (!jacobians[block]) continue;
    ahead[block].resize(2, sizes[block]);
    aside[block].resize(2, sizes[block]);
    ahead_to[block] = ahead[block].data();
    aside_to[block] = aside[block].data();
  }
  Vec2 moved;
  if (!ahead_->Evaluate(parameters, place->offset.data(), jacobians ? ahead_to.data() : nullptr) ||
      !aside_->Evaluate(parameters, moved.data(), jacobians ? aside_to.data() : nullptr))
    return false;
  place->inverse_depth = (place->offset.x() - moved.x()) / kAside_m;
  place->by_blocks.resize(sizes.size());
  for (size_t block = 0; jacobians && block < sizes.size(); ++block) {
    if (!jacobians[block]) continue;
    place->by_blocks[block].resize(3, sizes[block]);
    place->by_blocks[block] << ahead[block], (ahead[block].row(0) - aside[block].row(0)) / kAside_m;
  }
  return true;
}

bool PortFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const std::vector<int>& sizes = parameter_block_sizes();
  const size_t last = sizes.size() - 1;
  Place place;
  if (!locate(parameters, jacobians, &place)) return false;
  const double inverse_depth = std::max(place.inverse_depth, 1.0 / kFarthest_m);
  const Vec3 direction_C = bearing_C_ + tangent_C_ * place.offset;
  const bool is_ahead = place.offset.norm() < 0.1 * kOutlier;
  const auto seen = is_ahead ? Projection::of(*camera_, direction_C / inverse_depth, Vec3(parameters[last]),
                                              jacobians != nullptr)
                             : std::nullopt;
  Eigen::Map<Vec2> residual(residuals);
  residual = seen ? Vec2(weight_ * (seen->pixel - pixel_)) : Vec2::Constant(kOutlier);
  if (!jacobians) return true;
  Mat23 by_place = Mat23::Zero();
  if (seen) {
    const Mat23 by_point = weight_ * seen->by_point / inverse_depth;
    by_place.leftCols<2>() = by_point * tangent_C_;
    if (place.inverse_depth > 1.0 / kFarthest_m) by_place.col(2) = -by_point * direction_C / inverse_depth;
  }
  for (size_t block = 0; block < last; ++block) {
    if (jacobians[block])
      Eigen::Map<RowMajorBlock>(jacobians[block], 2, sizes[block]) = by_place * place.by_blocks[block];
  }
  if (jacobians[last]) {
    Eigen::Map<PortJacobian> by_port(jacobians[last]);
    by_port.setZero();
    if (seen) by_port = weight_ * seen->by_change;
  }
  return true;
}

}  // namespace lodeline

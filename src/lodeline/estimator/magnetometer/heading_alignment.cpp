#include "lodeline/estimator/magnetometer/heading_alignment.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "lodeline/ahrs/field_gate.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kLeastField_T = 15e-6;  // the Earth's field has 22 to 67 uT; hard iron may reduce it
constexpr double kMostField_T = 90e-6;

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }
double dipOf(const Vec3& field_W) { return FieldShape::of(field_W).dip_rad; }
double azimuthOf(const Vec3& field_W) { return std::atan2(field_W.y(), field_W.x()); }

/// Reason why the field gives no heading; empty where it does.
std::string refusalOf(const Vec3& field_W, const MagnetometerOptions& options) {
  const double norm_T = field_W.norm();
  if (!(norm_T > kLeastField_T && norm_T < kMostField_T))
    return fmt::format("field of {:.1f} uT; the Earth's has 22 to 67", 1e6 * norm_T);
  if (field_W.head<2>().norm() < options.min_horizontal_field_T) {
    return fmt::format("horizontal field of {:.1f} uT; a heading takes {:.1f}",
                       1e6 * field_W.head<2>().norm(), 1e6 * options.min_horizontal_field_T);
  }
  if (!options.site_field_W) return {};
  const Vec3& site_W = *options.site_field_W;
  if (std::abs(norm_T / site_W.norm() - 1.0) > options.max_start_norm_error) {
    return fmt::format("field of {:.1f} uT where the site has {:.1f}", 1e6 * norm_T, 1e6 * site_W.norm());
  }
  if (std::abs(dipOf(field_W) - dipOf(site_W)) > options.max_start_dip_error_rad) {
    return fmt::format("dip of {:.1f} degrees where the site has {:.1f}", degrees(dipOf(field_W)),
                       degrees(dipOf(site_W)));
  }
  return {};
}

}  // namespace

HeadingReference wantedReference(const MagnetometerOptions& options) {
  if (options.heading_reference != HeadingReference::Automatic) return options.heading_reference;
  return options.site_field_W ? HeadingReference::True : HeadingReference::Magnetic;
}

HeadingAlignment alignHeading(const Vec3& level_field_W, const MagnetometerOptions& options) {
  HeadingAlignment alignment;
  alignment.field_W = level_field_W;
  const HeadingReference wanted = wantedReference(options);
  if (wanted == HeadingReference::Start) return alignment;
  alignment.refusal = refusalOf(level_field_W, options);
  if (wanted == HeadingReference::True && !options.site_field_W)
    alignment.refusal = "true north takes the place and date of the recording";
  if (!alignment.refusal.empty()) return alignment;
  alignment.reference = wanted;
  alignment.yaw_rad = northFromWorld(level_field_W, wanted, options);
  alignment.field_W = so3::exp(alignment.yaw_rad * Vec3::UnitZ()) * level_field_W;
  return alignment;
}

double northFromWorld(const Vec3& field_W, HeadingReference reference, const MagnetometerOptions& options) {
  const double north = 0.5 * std::numbers::pi;  // azimuths count from east to north
  const double azimuth = reference == HeadingReference::True ? azimuthOf(*options.site_field_W) : north;
  return std::remainder(azimuth - azimuthOf(field_W), 2.0 * std::numbers::pi);
}

AzimuthCovariance azimuthCovariance(const Vec3& field_W, const Mat3& field,
                                    const Eigen::Matrix<double, 15, 3>& state_field) {
  const Vec3 by_field = Vec3::UnitZ().cross(field_W) / field_W.head<2>().squaredNorm();
  return {by_field.dot(field * by_field), state_field * by_field};
}

void relateToNorth(const NavigationState& state, const AzimuthCovariance& azimuth,
                   Eigen::Matrix<double, 15, 15>* covariance) {
  Eigen::Matrix<double, 15, 1> turn = Eigen::Matrix<double, 15, 1>::Zero();
  turn.head<9>() << Vec3::UnitZ().cross(state.world_from_body.translation), Vec3::UnitZ(),
      Vec3::UnitZ().cross(state.velocity_W);
  *covariance += azimuth.variance_rad2 * turn * turn.transpose() - turn * azimuth.with_state.transpose() -
                 azimuth.with_state * turn.transpose();
}

void turnWorld(double yaw_rad, Window* window, Prior* prior) {
  const Rigid3 turned_from_world(so3::exp(yaw_rad * Vec3::UnitZ()), Vec3::Zero());
  for (const auto& frame : window->frames()) {
    NavigationState state = frame->state();
    state.world_from_body = turned_from_world * state.world_from_body;
    state.velocity_W = turned_from_world.rotation * state.velocity_W;
    frame->setState(state);
  }
  // Position, roll and pitch, and velocity have the same sigma in all horizontal directions. Only their
  // values rotate.
  double* pose = prior->blocks[0].linearization_point.data();
  poseToBlock(turned_from_world * poseFromBlock(pose), pose);
  prior->blocks[1].linearization_point.head<3>() =
      turned_from_world.rotation * Vec3(prior->blocks[1].linearization_point.head<3>());
  // The correlation of roll and pitch (world axes) with the motion block (tieTiltToAccelerometerBias) rotates
  // as well.
  constexpr int kTilt = 3;
  auto ties = prior->sqrt_information.block<2, kMotionSize>(kTilt, kPoseTangentSize);
  ties = (Eigen::Rotation2Dd(yaw_rad).toRotationMatrix() * ties).eval();
}

}  // namespace lodeline

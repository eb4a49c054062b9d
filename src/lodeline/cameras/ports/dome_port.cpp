#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/cameras/ports/increasing_root.h"
#include "lodeline/cameras/ports/port_refraction.h"

namespace lodeline {
namespace {

/// Part `weight` asin(scale s) of a light path, with derivatives. s is the sine of the angle in air.
struct BendPart {
  double value = 0.0, by_sine = 0.0, by_scale = 0.0;

  BendPart(double scale, double sine) : value(std::asin(scale * sine)) {
    const double inverse_cosine = 1.0 / std::sqrt(1.0 - scale * sine * scale * sine);
    by_sine = scale * inverse_cosine;
    by_scale = sine * inverse_cosine;
  }
};

/// Angle at the centre of the spheres from the axis to the point, for the angle in air (alpha), minus its
/// true one. The product of index and distance of the ray from the centre is the same in all media (Bouguer's
/// law): n_a l sin(alpha), with the lens l behind the centre. A ray at the distance q from the centre makes
/// the angle asin(q / R) with the normal of a sphere of the radius R. Hence
///
///     g(alpha) = alpha + asin(q_a / R_1) - asin(q_g / R_1) + asin(q_g / R_2) - asin(q_w / R_2)
///                + asin(q_w / R) - phi
///
/// with the distance R and the angle phi of the point.
struct DomePath {
  const Port& port;
  double offset_m = 0.0, range_m = 0.0, angle_rad = 0.0;
  double outer_m = port.radius_m + port.thickness_m;

  /// The five quotients q / (R sin(alpha)), in the order and with the signs of g.
  static constexpr int kParts = 5;
  static constexpr double kSigns[kParts] = {1.0, -1.0, 1.0, -1.0, 1.0};
  double radius(int part) const { return part < 2 ? port.radius_m : part < 4 ? outer_m : range_m; }
  double index(int part) const {
    return part == 0 ? port.index_air : part < 3 ? port.index_glass : port.index_water;
  }
  double scale(int part) const { return port.index_air * offset_m / (index(part) * radius(part)); }

  ValueAndSlope operator()(double alpha) const {
    const double sine = std::sin(alpha), cosine = std::cos(alpha);
    ValueAndSlope sum{alpha - angle_rad, 1.0};
    for (int k = 0; k < kParts; ++k) {
      const BendPart part(scale(k), sine);
      sum.value += kSigns[k] * part.value;
      sum.slope += kSigns[k] * part.by_sine * cosine;
    }
    return sum;
  }

  /// Sum of the quotients: g is alpha + bend sin(alpha) - phi for a small offset.
  double bend() const {
    double sum = 0.0;
    for (int k = 0; k < kParts; ++k) sum += kSigns[k] * scale(k);
    return sum;
  }

  std::optional<double> angleInAir() const {
    double greatest = 0.0;
    for (int k = 0; k < kParts; ++k) greatest = std::max(greatest, scale(k));
    const double high = greatest < 1.0 ? std::numbers::pi : std::asin(1.0 / greatest);
    const double start =
        angle_rad / (1.0 + bend() * (angle_rad > 0.0 ? std::sin(angle_rad) / angle_rad : 1.0));
    return increasingRoot(*this, 0.0, std::clamp(start, 0.0, high), high);
  }
};

/// Derivatives of the angle in air, from g(alpha) = 0.
struct AngleInAir {
  double alpha = 0.0, by_g = 0.0, by_range = 0.0;
  Eigen::Matrix<double, 6, 1> by_port;  ///< offset, inner radius, thickness, three indices

  AngleInAir(const DomePath& path, double solution) : alpha(solution), by_g(-1.0 / path(solution).slope) {
    by_port.setZero();
    for (int k = 0; k < DomePath::kParts; ++k) {
      const double by_log_scale =
          DomePath::kSigns[k] * BendPart(path.scale(k), std::sin(alpha)).by_scale * path.scale(k);
      const double by_radius = -by_log_scale / path.radius(k);
      if (k == 4) by_range = by_g * by_radius;
      if (k < 4) by_port[1] += by_radius;
      if (k == 2 || k == 3) by_port[2] += by_radius;
      if (path.offset_m > 0.0) by_port[0] += by_log_scale / path.offset_m;
      by_port[3] += by_log_scale / path.port.index_air;
      by_port[k == 0 ? 3 : k < 3 ? 4 : 5] -= by_log_scale / path.index(k);
    }
    by_port *= by_g;
  }
};

/// Dome of two concentric spheres. The plane of refraction contains the lens, the centre and the point.
class DomePortRefraction final : public PortRefraction {
 public:
  explicit DomePortRefraction(const Port& port)
      : port_(port), offset_m_(port.centre_C.norm()), axis_(Vec3::UnitZ()) {
    // A dome around the lens has every line as its axis.
    if (offset_m_ > 0.0) axis_ = port.centre_C / offset_m_;
  }

  std::optional<Vec3> towards(const Vec3& point_C, Mat3* by_point, DirectionByPort* by_port) const override {
    const Vec3 from_centre_C = point_C - port_.centre_C;
    const double height_m = axis_.dot(from_centre_C);
    const Vec3 across_C = point_C - axis_.dot(point_C) * axis_;
    const double radius_m = across_C.norm(), range_m = std::hypot(height_m, radius_m);
    const DomePath path{port_, offset_m_, range_m, std::atan2(radius_m, height_m)};
    if (!(range_m > path.outer_m) || !std::isfinite(range_m)) return std::nullopt;
    const std::optional<double> alpha = path.angleInAir();
    if (!alpha) return std::nullopt;
    const double sine = std::sin(*alpha), cosine = std::cos(*alpha);
    const Vec3 outwards = radius_m > 0.0 ? Vec3(across_C / radius_m) : Vec3(Vec3::Zero());
    const Vec3 direction_C = cosine * axis_ + sine * outwards;
    if (!by_point && !by_port) return direction_C;

    const AngleInAir angle(path, *alpha);
    const double range_squared = range_m * range_m;
    const double by_radius = -angle.by_g * height_m / range_squared + angle.by_range * radius_m / range_m;
    const double by_height = angle.by_g * radius_m / range_squared + angle.by_range * height_m / range_m;
    const double per_radius = radius_m > 0.0 ? sine / radius_m : by_radius * cosine;
    const Vec3 by_angle = cosine * outwards - sine * axis_;
    Mat3 direction_by_point =
        per_radius * (Mat3::Identity() - axis_ * axis_.transpose() - outwards * outwards.transpose()) +
        by_angle * (by_radius * outwards + by_height * axis_).transpose();
    if (by_port) {
      by_port->resize(3, 8);
      by_port->leftCols<3>() =
          byCentre(point_C, direction_C, direction_by_point, (angle.by_port[0] - by_height) * by_angle, path);
      by_port->rightCols<5>() = by_angle * angle.by_port.tail<5>().transpose();
    }
    if (by_point) *by_point = direction_by_point;
    return direction_C;
  }

  std::optional<ViewRay> through(const Vec3& direction_C) const override {
    const Vec3 in_air = direction_C.normalized();
    const Vec3 inner_C = onSphere(Vec3::Zero(), in_air, port_.radius_m);
    const auto in_glass = refractedDirection(in_air, (inner_C - port_.centre_C) / port_.radius_m,
                                             port_.index_air / port_.index_glass);
    if (!in_glass) return std::nullopt;
    const double outer_m = port_.radius_m + port_.thickness_m;
    const Vec3 outer_C = onSphere(inner_C, *in_glass, outer_m);
    const auto in_water = refractedDirection(*in_glass, (outer_C - port_.centre_C) / outer_m,
                                             port_.index_glass / port_.index_water);
    if (!in_water) return std::nullopt;
    return ViewRay{outer_C, *in_water};
  }

 private:
  /// Point in which a line from within leaves a sphere.
  Vec3 onSphere(const Vec3& from_C, const Vec3& direction, double radius_m) const {
    const Vec3 from_centre_C = from_C - port_.centre_C;
    const double towards_m = -direction.dot(from_centre_C);
    const double closest_squared = from_centre_C.squaredNorm() - towards_m * towards_m;
    return from_C + (towards_m + std::sqrt(std::max(0.0, radius_m * radius_m - closest_squared))) * direction;
  }

  /// Derivative by the centre. Along the axis it is `by_offset`. A movement across the axis turns the axis
  /// about the lens; turning the point back has the same effect in turned axes. For an offset near zero, g
  /// gives the derivative (bend - 1 / R) across the direction itself.
  Mat3 byCentre(const Vec3& point_C, const Vec3& direction_C, const Mat3& by_point, const Vec3& by_offset,
                const DomePath& path) const {
    constexpr double kSmallOffset = 1e-8;
    if (offset_m_ < kSmallOffset * port_.radius_m) {
      DomePath unit = path;
      unit.offset_m = 1.0;
      return (unit.bend() - 1.0 / path.range_m) * (Mat3::Identity() - direction_C * direction_C.transpose());
    }
    Mat3 by_centre = by_offset * axis_.transpose();
    for (int i = 0; i < 3; ++i) {
      const Vec3 turn = axis_.cross(Vec3::Unit(i)) / offset_m_;
      by_centre.col(i) += turn.cross(direction_C) - by_point * turn.cross(point_C);
    }
    return by_centre;
  }

  Port port_;
  double offset_m_;
  Vec3 axis_;
};

}  // namespace

std::unique_ptr<const PortRefraction> makeDomePort(const Port& port) {
  return std::make_unique<DomePortRefraction>(port);
}

}  // namespace lodeline

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/cameras/ports/increasing_root.h"
#include "lodeline/cameras/ports/port_refraction.h"

namespace lodeline {
namespace {

/// Tangent of the angle to the normal in a medium, as a function of that in air (u), and its derivatives.
/// With Snell's law
///
///     tan = n_a u / sqrt(n^2 (1 + u^2) - n_a^2 u^2).
struct MediumTangent {
  double value = 0.0, by_air = 0.0, by_index = 0.0, by_index_air = 0.0;

  MediumTangent(double u, double n, double n_air) {
    const double secant_squared = 1.0 + u * u;
    const double inverse = 1.0 / std::sqrt(n * n * secant_squared - n_air * n_air * u * u);
    const double cubed = inverse * inverse * inverse;
    value = n_air * u * inverse;
    by_air = n_air * n * n * cubed;
    by_index = -n_air * u * n * secant_squared * cubed;
    by_index_air = -by_index * n / n_air;
  }
};

/// Distance of the point from the normal through the lens, as a function of the tangent in air (u), minus its
/// true one:
///
///     f(u) = distance u + thickness tan_glass(u) + height tan_water(u) - radius
///
/// `height` is the distance of the point from the outer face.
struct FlatPath {
  const Port& port;
  double height_m, radius_m;

  ValueAndSlope operator()(double u) const {
    const MediumTangent glass(u, port.index_glass, port.index_air),
        water(u, port.index_water, port.index_air);
    return {port.distance_m * u + port.thickness_m * glass.value + height_m * water.value - radius_m,
            port.distance_m + port.thickness_m * glass.by_air + height_m * water.by_air};
  }

  /// The tangent in air. Near the normal, all light seems to come from one point, the paraxial image of the
  /// lens. The line from there to the point gives an angle in the water. Its error is of the order of
  /// distance over height.
  std::optional<double> tangentInAir() const {
    const double n_a = port.index_air, n_g = port.index_glass, n_w = port.index_water;
    const double inside_m = port.distance_m / n_a + port.thickness_m / n_g;
    const double slope = radius_m / (height_m + n_w * inside_m);
    const double rest = n_a * n_a * (1.0 + slope * slope) - n_w * n_w * slope * slope;
    const double paraxial = radius_m / (n_a * (inside_m + height_m / n_w));
    double high = std::numeric_limits<double>::infinity();
    const double least = std::min(n_g, n_w);
    if (least < n_a) high = least / std::sqrt(n_a * n_a - least * least);
    const double start = rest > 0.0 ? n_w * slope / std::sqrt(rest) : paraxial;
    return increasingRoot(*this, 0.0, start < high ? start : 0.5 * std::min(high, 2.0 * paraxial), high);
  }
};

/// Plane glass plate. The plane of refraction contains its normal a through the lens.
class FlatPortRefraction final : public PortRefraction {
 public:
  explicit FlatPortRefraction(const Port& port) : port_(port), axis_(port.normal_C.normalized()) {}

  std::optional<Vec3> towards(const Vec3& point_C, Mat3* by_point, DirectionByPort* by_port) const override {
    const double along_m = axis_.dot(point_C);
    const Vec3 across_C = point_C - along_m * axis_;
    const FlatPath path{port_, along_m - port_.distance_m - port_.thickness_m, across_C.norm()};
    if (!(path.height_m > 0.0) || !std::isfinite(path.radius_m)) return std::nullopt;
    const std::optional<double> u = path.tangentInAir();
    if (!u) return std::nullopt;
    const double by_radius = 1.0 / path(*u).slope;
    const double per_radius = path.radius_m > 0.0 ? *u / path.radius_m : by_radius;
    if (by_point || by_port) {
      const Vec3 outwards = path.radius_m > 0.0 ? Vec3(across_C / path.radius_m) : Vec3(Vec3::Zero());
      const MediumTangent water(*u, port_.index_water, port_.index_air);
      const double by_height = -water.value * by_radius;
      if (by_point) {
        *by_point = per_radius * (Mat3::Identity() - axis_ * axis_.transpose()) +
                    outwards * ((by_radius - per_radius) * outwards + by_height * axis_).transpose();
      }
      if (by_port) setByPort(point_C, *u, per_radius, by_radius, outwards, by_port);
    }
    return Vec3(axis_ + per_radius * across_C);
  }

  std::optional<ViewRay> through(const Vec3& direction_C) const override {
    const Vec3 in_air = direction_C.normalized();
    const auto in_glass = refractedDirection(in_air, axis_, port_.index_air / port_.index_glass);
    if (!in_glass) return std::nullopt;
    const auto in_water = refractedDirection(*in_glass, axis_, port_.index_glass / port_.index_water);
    if (!in_water) return std::nullopt;
    const Vec3 inner_C = port_.distance_m / in_air.dot(axis_) * in_air;
    return ViewRay{inner_C + port_.thickness_m / in_glass->dot(axis_) * *in_glass, *in_water};
  }

 private:
  /// Derivative of a + (u / r) (p - (a p) a), where the radius r and the tangent u depend on the port as
  /// well.
  void setByPort(const Vec3& point_C, double u, double per_radius, double by_radius, const Vec3& outwards,
                 DirectionByPort* by_port) const {
    const MediumTangent glass(u, port_.index_glass, port_.index_air);
    const MediumTangent water(u, port_.index_water, port_.index_air);
    const double along_m = axis_.dot(point_C), radius_m = outwards.dot(point_C);
    const double height_m = along_m - port_.distance_m - port_.thickness_m;
    const double lean = radius_m > 0.0 ? along_m / radius_m : 0.0;
    const double by_turn = lean * (per_radius - by_radius) - water.value * by_radius;
    const Vec3 by_f = -by_radius * outwards;
    by_port->resize(3, 7);
    for (int tilt = 0; tilt < 2; ++tilt) {
      const Vec3 change = Vec3::Unit(tilt).cross(axis_);
      by_port->col(tilt) = (1.0 - per_radius * along_m) * change +
                           point_C.dot(change) * (by_turn * outwards - per_radius * axis_);
    }
    by_port->col(2) = (u - water.value) * by_f;
    by_port->col(3) = (glass.value - water.value) * by_f;
    by_port->col(4) = (port_.thickness_m * glass.by_index_air + height_m * water.by_index_air) * by_f;
    by_port->col(5) = port_.thickness_m * glass.by_index * by_f;
    by_port->col(6) = height_m * water.by_index * by_f;
  }

  Port port_;
  Vec3 axis_;
};

}  // namespace

std::unique_ptr<const PortRefraction> makeFlatPort(const Port& port) {
  return std::make_unique<FlatPortRefraction>(port);
}

}  // namespace lodeline

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "simulation/motion/vehicle_motion.h"
#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kTransect_m = 30.0;
constexpr double kSpacing_m = 1.5;
constexpr double kTurn_s = 8.0;
constexpr double kHover_s = 10.0;

/// Mean height of the ground around a place, which an altitude controller follows.
double smoothGround(const GroundHeight& ground, double east_m, double north_m) {
  constexpr double kReach_m = 1.2;
  double sum = 0.0;
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) sum += ground(east_m + kReach_m * i, north_m + kReach_m * j);
  }
  return sum / 9.0;
}

std::vector<VehicleLeg> transects(const GroundHeight& ground, double altitude_m, double path_length_m,
                                  double azimuth) {
  const double wanted_m = std::min(kTransect_m, std::max(4.0, path_length_m / 3.0));
  const int count =
      std::max(1, static_cast<int>(std::lround((path_length_m + kSpacing_m) / (wanted_m + kSpacing_m))));
  const double length_m = std::max(0.5, (path_length_m - (count - 1) * kSpacing_m) / count);
  const Vec3 along(std::cos(azimuth), std::sin(azimuth), 0.0);
  const Vec3 aside = Vec3::UnitZ().cross(along);
  std::vector<VehicleLeg> route;
  const auto add = [&](const Vec3& from, const Vec3& way, double leg_m, double yaw, double pause_s) {
    const auto position = [=](double s) {
      Vec3 place = from + s * way;
      place.z() = smoothGround(ground, place.x(), place.y()) + altitude_m;
      return place;
    };
    route.push_back({leg_m, position, [=](double) { return yaw; }, pause_s});
  };
  for (int i = 0; i < count; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 from = i * kSpacing_m * aside + (i % 2 == 0 ? 0.0 : length_m) * along;
    const double yaw = azimuth + (i % 2 == 0 ? 0.0 : std::numbers::pi);
    if (i % 3 == 1) {
      add(from, sign * along, 0.5 * length_m, yaw, kHover_s);
      add(from + 0.5 * length_m * sign * along, sign * along, 0.5 * length_m, yaw, 1.0);
    } else {
      add(from, sign * along, length_m, yaw, 1.0);
    }
    // Sideways to the next transect.
    if (i + 1 < count) add(from + length_m * sign * along, aside, kSpacing_m, yaw, kTurn_s);
  }
  return route;
}

/// A ring around a hull by arc length, in axes of the wreck (x to the bow) from its centre.
class HullRing {
 public:
  explicit HullRing(const WreckLayout& wreck)
      : half_along_m_(0.5 * wreck.length_m + kDistance_m), half_across_m_(0.5 * wreck.width_m + kDistance_m) {
    for (int i = 0; i < kPieces; ++i) length_m_.push_back(length_m_.back() + (at(i + 1.0) - at(i)).norm());
  }
  double circumference_m() const { return length_m_.back(); }
  double end_m() const { return half_along_m_; }  ///< where the ring crosses the keel line

  /// From the bow, counter-clockwise.
  Vec3 position(double along_m) const {
    const double within_m = along_m - circumference_m() * std::floor(along_m / circumference_m());
    const auto above = std::upper_bound(length_m_.begin() + 1, length_m_.end() - 1, within_m);
    const double begin_m = *(above - 1);
    return at(static_cast<double>(above - 1 - length_m_.begin()) + (within_m - begin_m) / (*above - begin_m));
  }

 private:
  static constexpr double kDistance_m = 3.5;
  static constexpr int kPieces = 720;
  Vec3 at(double piece) const {
    const double angle = 2.0 * std::numbers::pi * piece / kPieces;
    return Vec3(half_along_m_ * std::cos(angle), half_across_m_ * std::sin(angle), 0.0);
  }

  double half_along_m_, half_across_m_;
  std::vector<double> length_m_ = {0.0};
};

/// Route in axes of the wreck from its centre.
std::vector<VehicleLeg> wreckRoute(const WreckLayout& wreck, int laps, uint64_t seed) {
  constexpr double kHeight_m = 2.2;
  const auto ring = std::make_shared<HullRing>(wreck);
  const Waves rise(seed, "vehicle/wreck/rise", 15.0, 60.0);
  const double end_m = ring->end_m();
  std::vector<VehicleLeg> route;
  const auto straight = [&](double from_m, double to_m, double pause_s) {
    const double sign = to_m > from_m ? 1.0 : -1.0;
    const double yaw = sign > 0.0 ? 0.0 : std::numbers::pi;
    route.push_back({std::abs(to_m - from_m),
                     [=](double s) { return Vec3(from_m + sign * s, 0.0, kHeight_m); },
                     [=](double) { return yaw; }, pause_s});
  };
  straight(end_m + kWreckApproach_m, end_m, kTurn_s);
  const double reach_m = 0.35 * wreck.length_m;
  for (int lap = 0; lap < laps; ++lap) {
    const double begin_m = lap % 2 == 0 ? 0.0 : 0.5 * ring->circumference_m();
    const auto onRing = [=](double s) { return ring->position(begin_m + s); };
    const double circumference_m = ring->circumference_m();
    const auto place = [=](double s) {
      // Even at both ends of the lap.
      const double share = std::sin(std::numbers::pi * std::clamp(s / circumference_m, 0.0, 1.0));
      return Vec3(onRing(s) + (kHeight_m + 0.7 * share * std::tanh(rise(s + 200.0 * lap))) * Vec3::UnitZ());
    };
    // The view is at the keel line beside the vehicle. It turns with the vehicle, so angles are unwrapped.
    const auto facing = [=](double s) {
      const Vec3 here = onRing(s);
      const Vec3 aim(reach_m * std::tanh(here.x() / reach_m), 0.0, 0.0);
      const double turned = 2.0 * std::numbers::pi * (begin_m + s) / circumference_m + std::numbers::pi;
      return turned + std::remainder(std::atan2(aim.y() - here.y(), aim.x() - here.x()) - turned,
                                     2.0 * std::numbers::pi);
    };
    route.push_back({circumference_m, place, facing, kTurn_s});
    const double from_m = lap % 2 == 0 ? end_m : -end_m;
    straight(from_m, -from_m, kTurn_s);
  }
  const double last_m = laps % 2 == 0 ? end_m : -end_m;
  straight(last_m, last_m + (last_m > 0.0 ? kWreckApproach_m : -kWreckApproach_m), 0.0);
  return route;
}

/// Cuts a route to a length.
void shorten(double length_m, std::vector<VehicleLeg>* route) {
  for (size_t i = 0; i < route->size(); ++i) {
    if ((*route)[i].length_m >= length_m) {
      (*route)[i].length_m = std::max(0.5, length_m);
      route->resize(i + 1);
      return;
    }
    length_m -= (*route)[i].length_m;
  }
}

}  // namespace

Motion makeTransectMotion(const GroundHeight& ground, double altitude_m, double path_length_m,
                          const VehicleMotionOptions& options, const Rigid3& vehicle_from_body) {
  const double azimuth = Random(options.seed, "vehicle/azimuth").uniform(0.0, 2.0 * std::numbers::pi);
  const auto make = [&](double length_m) {
    return makeVehicleMotion(transects(ground, altitude_m, length_m, azimuth), options, vehicle_from_body);
  };
  const double ratio = path_length_m / pathLength(make(path_length_m), 0.0, options.duration_s);
  return make(path_length_m * ratio);
}

double wreckLapLength_m(const WreckLayout& wreck, int laps) {
  double length_m = 0.0;
  for (const VehicleLeg& leg : wreckRoute(wreck, laps, 1)) length_m += leg.length_m;
  return length_m;
}

Motion makeWreckLapMotion(const WreckLayout& wreck, int laps, double path_length_m,
                          const VehicleMotionOptions& options, const Rigid3& vehicle_from_body) {
  const Eigen::AngleAxisd heading(wreck.azimuth_rad, Vec3::UnitZ());
  const auto make = [&](double length_m) {
    std::vector<VehicleLeg> route = wreckRoute(wreck, laps, options.seed);
    shorten(length_m, &route);
    for (VehicleLeg& leg : route) {
      leg.position = [=, position = leg.position](double s) {
        return Vec3(wreck.center_W + heading * position(s));
      };
      leg.yaw_rad = [=, yaw = leg.yaw_rad](double s) { return wreck.azimuth_rad + yaw(s); };
    }
    return makeVehicleMotion(route, options, vehicle_from_body);
  };
  const double ratio = path_length_m / pathLength(make(path_length_m), 0.0, options.duration_s);
  return make(path_length_m * ratio);
}

}  // namespace lodeline

#include "simulation/vehicle/vehicle_currents.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

struct LampSwitching {
  std::vector<double> toggles_s;  ///< first on, then off, and so on

  bool isOn(double time_s) const {
    size_t passed = 0;
    while (passed < toggles_s.size() && time_s >= toggles_s[passed]) ++passed;
    return passed % 2 == 1;
  }
};

LampSwitching drawSwitching(double duration_s, Random& random) {
  LampSwitching switching;
  for (double t = random.uniform(2.0, 4.0); t < duration_s;) {
    switching.toggles_s.push_back(t);
    const bool on = switching.toggles_s.size() % 2 == 1;
    t += on ? random.uniform(60.0, 180.0) : random.uniform(5.0, 20.0);
  }
  return switching;
}

}  // namespace

const std::vector<std::string>& currentChannels() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> made;
    for (int i = 1; i <= kThrusters; ++i) made.push_back(fmt::format("thruster_{}", i));
    for (int i = 1; i <= kLamps; ++i) made.push_back(fmt::format("lamp_{}", i));
    made.push_back("battery");
    return made;
  }();
  return names;
}

std::vector<double> channelCurrents(const ElectricLoads& loads) {
  std::vector<double> currents_A(loads.thrusters_A.begin(), loads.thrusters_A.end());
  currents_A.insert(currents_A.end(), loads.lamps_A.begin(), loads.lamps_A.end());
  double sum_A = loads.electronics_A;
  for (const double current_A : currents_A) sum_A += current_A;
  currents_A.push_back(sum_A);
  return currents_A;
}

LoadsFunction drawVehicleLoads(std::shared_ptr<const VehicleThrust> thrust, double duration_s,
                               uint64_t seed) {
  Random random(seed, "vehicle/lamps");
  std::array<LampSwitching, kLamps> lamps;
  for (LampSwitching& lamp : lamps) lamp = drawSwitching(duration_s, random);
  const Waves electronics(seed, "vehicle/electronics", 8.0, 60.0);
  return [=](double t) {
    ElectricLoads loads;
    const Thrusts thrusts = thrust->at(t);
    for (int i = 0; i < kThrusters; ++i) loads.thrusters_A[i] = thrust->current_A(thrusts[i]);
    for (int i = 0; i < kLamps; ++i) loads.lamps_A[i] = lamps[i].isOn(t) ? kLampCurrent_A : 0.0;
    loads.electronics_A = 1.5 + 0.3 * std::tanh(electronics(t));
    return loads;
  };
}

std::vector<Vec3> drawCurrentFields(uint64_t seed, bool cables_moved) {
  Random random(seed, "vehicle/cables"), moved(seed, "vehicle/cables/moved");
  const auto draw = [&](double least_T, double most_T, double at_A) {
    const double size_T = random.uniform(least_T, most_T);
    Vec3 field = size_T / at_A * random.direction();
    const double angle_rad = moved.uniform(30.0, 70.0) * kDegree;
    const Vec3 axis = field.cross(moved.direction()).normalized();
    const double ratio = moved.uniform(0.6, 1.5);
    if (cables_moved) field = ratio * (so3::exp(angle_rad * axis) * field);
    return field;
  };
  std::vector<Vec3> fields;
  for (int i = 0; i < kThrusters; ++i) fields.push_back(draw(6e-6, 12e-6, 20.0));
  for (int i = 0; i < kLamps; ++i) fields.push_back(draw(0.1e-6, 0.4e-6, kLampCurrent_A));
  fields.push_back(draw(0.3e-6, 1.0e-6, 20.0));
  return fields;
}

Vec3 fieldOfCurrents(const std::vector<Vec3>& fields_T_per_A, const std::vector<double>& currents_A) {
  Vec3 sum = Vec3::Zero();
  for (size_t i = 0; i < fields_T_per_A.size(); ++i) sum += currents_A[i] * fields_T_per_A[i];
  return sum;
}

CurrentSensorModel::CurrentSensorModel(LoadsFunction loads, const CurrentSensorErrors& errors, uint64_t seed)
    : loads_(std::move(loads)), errors_(errors), noise_(seed, "currents") {}

std::vector<double> CurrentSensorModel::measure(double time_s) {
  std::vector<double> readings_A = channelCurrents(loads_(time_s));
  for (double& reading_A : readings_A) {
    reading_A += errors_.noise_A * noise_.normal();
    if (errors_.resolution_A > 0.0)
      reading_A = std::round(reading_A / errors_.resolution_A) * errors_.resolution_A;
  }
  return readings_A;
}

}  // namespace lodeline

#include "simulation/sensors/sonar_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lodeline {

SonarModel::SonarModel(const Motion& motion, const Rigid3& body_from_sonar, RangeFunction range,
                       const SonarErrors& errors, uint64_t seed, std::string_view random_stream)
    : motion_(motion),
      body_from_sonar_(body_from_sonar),
      range_(std::move(range)),
      errors_(errors),
      random_(seed, random_stream) {}

double SonarModel::angleAt_rad(double time_s) const {
  const double around_rad = std::remainder(errors_.turn_rad_per_s * time_s, 2.0 * std::numbers::pi);
  if (errors_.sector_rad <= 0.0) return around_rad;
  // A triangle wave of the same rate: from one border of the sector to the other and back.
  const double period_rad = 4.0 * errors_.sector_rad;
  const double way_rad = std::remainder(errors_.turn_rad_per_s * time_s, period_rad);
  return std::abs(way_rad) - errors_.sector_rad;
}

std::optional<SonarSample> SonarModel::measure(double time_s) {
  // Drawn before any decision, so that the loss of one echo does not change the noise of the next one.
  const double noise_m = errors_.noise_m * random_.normal();
  const bool lost = random_.chance(errors_.dropout_share);
  const bool spurious = random_.chance(errors_.spurious_share);
  const double share = random_.uniform();

  const double angle_rad = angleAt_rad(time_s);
  const Rigid3 world_from_sonar = motion_.at(time_s).world_from_body * body_from_sonar_;
  const Vec3 direction_W = world_from_sonar.rotation * Vec3(std::cos(angle_rad), std::sin(angle_rad), 0.0);
  const std::optional<double> range_m = range_(world_from_sonar.translation, direction_W);
  if (lost || !range_m) return std::nullopt;
  double reading = *range_m + noise_m;
  if (spurious) reading = errors_.nearest_m + share * std::max(0.0, reading - errors_.nearest_m);
  if (errors_.resolution_m > 0.0) reading = std::round(reading / errors_.resolution_m) * errors_.resolution_m;
  if (reading < errors_.nearest_m || reading > errors_.farthest_m) return std::nullopt;
  SonarSample sample;
  sample.range_m = reading;
  sample.angle_rad = angle_rad;
  return sample;
}

}  // namespace lodeline

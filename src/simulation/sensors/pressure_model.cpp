#include "simulation/sensors/pressure_model.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

PressureModel::PressureModel(const Motion& motion, const Rigid3& body_from_pressure, double surface_height_m,
                             const PressureErrors& errors, uint64_t seed)
    : motion_(motion),
      body_from_pressure_(body_from_pressure),
      surface_height_m_(surface_height_m),
      errors_(errors),
      noise_(seed, "pressure/white") {}

double PressureModel::depthOfPressure(double time_s) const {
  const Rigid3 world_from_body = motion_.at(time_s).world_from_body;
  const double depth_m = surface_height_m_ - (world_from_body * body_from_pressure_.translation).z();
  if (!errors_.halocline_depth_m) return depth_m;
  return depth_m + errors_.density_step * std::max(0.0, depth_m - *errors_.halocline_depth_m);
}

double PressureModel::measure(double time_s) {
  if (!started_ || errors_.lag_s <= 0.0) {
    lagged_m_ = depthOfPressure(time_s);
    started_ = true;
  } else {
    // Steps well below both the lag and the breathing period.
    const int steps = std::max(1, static_cast<int>(std::ceil((time_s - last_s_) / 0.05)));
    const double step_s = (time_s - last_s_) / steps;
    const double keep = std::exp(-step_s / errors_.lag_s);
    for (int i = 1; i <= steps; ++i) {
      lagged_m_ = keep * lagged_m_ + (1.0 - keep) * depthOfPressure(last_s_ + (i - 0.5) * step_s);
    }
  }
  last_s_ = time_s;
  double reading = errors_.density_ratio * lagged_m_ + errors_.offset_m + errors_.noise_m * noise_.normal();
  if (errors_.resolution_m > 0.0) reading = std::round(reading / errors_.resolution_m) * errors_.resolution_m;
  return reading;
}

}  // namespace lodeline

#pragma once

#include <functional>
#include <optional>

#include "simulation/shared/motion.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a real depth gauge: the pressure of the real water is converted with an assumed density, after a
/// first-order lag of the membrane.
///   reading = round(density_ratio * lagged depth + offset + noise)
/// Below a halocline, each metre weighs more: it counts (1 + density_step) in the depth.
struct PressureErrors {
  double noise_m = 0.0;
  double resolution_m = 0.0;  ///< 0: continuous
  double offset_m = 0.0;
  double lag_s = 0.0;          ///< time constant
  double density_ratio = 1.0;  ///< true density divided by assumed density
  std::optional<double> halocline_depth_m = std::nullopt;
  double density_step = 0.0;  ///< of the water below the halocline, relative to that above
};

class PressureModel {
 public:
  /// `surface_height_m`: height of the water surface above the world's origin. `motion` must outlive the
  /// model.
  PressureModel(const Motion& motion, const Rigid3& body_from_pressure, double surface_height_m,
                const PressureErrors& errors, uint64_t seed);

  /// Depth reading at `time_s`, m, positive down; call it in order of time.
  double measure(double time_s);

 private:
  /// Depth in water of the upper density with the same pressure, m.
  double depthOfPressure(double time_s) const;

  const Motion& motion_;
  Rigid3 body_from_pressure_;
  double surface_height_m_;
  PressureErrors errors_;
  Random noise_;
  bool started_ = false;
  double last_s_ = 0.0, lagged_m_ = 0.0;
};

}  // namespace lodeline

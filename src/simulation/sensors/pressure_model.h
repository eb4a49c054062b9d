#pragma once

#include <functional>

#include "simulation/shared/motion.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a real depth gauge: the pressure of the real water is converted with an assumed density, after a
/// first-order lag of the membrane.
///   reading = round(density_ratio * lagged depth + offset + noise)
struct PressureErrors {
  double noise_m = 0.0;
  double resolution_m = 0.0;  ///< 0: continuous
  double offset_m = 0.0;
  double lag_s = 0.0;          ///< time constant
  double density_ratio = 1.0;  ///< true density divided by assumed density
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
  double trueDepth(double time_s) const;

  const Motion& motion_;
  Rigid3 body_from_pressure_;
  double surface_height_m_;
  PressureErrors errors_;
  Random noise_;
  bool started_ = false;
  double last_s_ = 0.0, lagged_m_ = 0.0;
};

}  // namespace lodeline

#pragma once

#include <deque>
#include <optional>
#include <span>

#include "lodeline/estimate.h"
#include "lodeline/estimator/dvl/ping_motion.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Keeps the last second of inertial readings, and integrates them from pings to frames.
class PingIntegrator {
 public:
  static constexpr double kLongest_s = 1.0;

  PingIntegrator(const ImuCalibration& imu, const PreintegrationOptions& options)
      : imu_(imu), options_(options) {}

  void add(std::span<const ImuSample> samples);

  /// The motion from a ping to a frame with these biases; empty where the readings do not cover it.
  std::optional<PingMotion> motion(Time ping, const NavigationState& frame) const;

 private:
  ImuCalibration imu_;
  PreintegrationOptions options_;
  std::deque<ImuSample> samples_;
};

}  // namespace lodeline

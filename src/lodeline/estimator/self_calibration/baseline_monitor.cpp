#include "lodeline/estimator/self_calibration/baseline_monitor.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/factors/calibrated_reprojection_factor.h"

namespace lodeline {

BaselineMonitor::BaselineMonitor(const Rig& rig) {
  for (size_t i = 1; i < rig.cameras.size(); ++i) {
    baselines_.push_back({rig.cameras[i].name,
                          rig.cameras.front().body_from_camera.inverse() * rig.cameras[i].body_from_camera});
  }
}

void BaselineMonitor::add(Time time, const CameraCorrections& corrections, Diagnostics* diagnostics) {
  constexpr double kWorthSaying = 0.01;  // of the baseline
  constexpr int kFrames = 100;           // fewer may be a temporary error of the motion
  for (size_t i = 0; i < baselines_.size(); ++i) {
    Baseline& baseline = baselines_[i];
    if (baseline.is_reported) continue;
    const double stated_m = baseline.camera0_from_camera.translation.norm();
    const double found_m =
        correctedExtrinsics(baseline.camera0_from_camera, corrections.extrinsics[i + 1].data())
            .translation.norm();
    baseline.frames_off =
        std::abs(found_m - stated_m) > kWorthSaying * stated_m ? baseline.frames_off + 1 : 0;
    if (baseline.frames_off < kFrames) continue;
    baseline.is_reported = true;
    diagnostics->report(
        Severity::Warning, "baseline_differs",
        fmt::format(
            "camera '{}': at {} ns motion and images put it {:.1f} mm from the first camera, its "
            "calibration {:.1f} mm; estimated from there on. Was the length of the calibration target "
            "right?",
            baseline.camera, time.nanoseconds(), 1e3 * found_m, 1e3 * stated_m));
  }
}

}  // namespace lodeline

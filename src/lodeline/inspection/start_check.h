#pragma once

#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/inspection/inspection.h"

namespace lodeline {

/// Kind of the finding that no estimate of a run can be trusted, because the sensors contradict each other.
inline constexpr const char* kSensorsContradict = "sensors_contradict";

struct StartCheckOptions {
  double begin_s = 0.0;    ///< after the first image
  double length_s = 20.0;  ///< of the part that is checked
};

/// Results of the check that a run uses.
struct StartCheck {
  /// To be added to the time stamps of each camera's images, where the first seconds show a significant
  /// offset; else 0.
  std::vector<double> image_offset_s;
  double rate_to_SI = 1.0;  ///< takes the gyroscope's readings to rad/s
  WhiteNoise noise;         ///< estimated from the readings
};

/// Fast check before a run: inspects the first seconds of a recording with a few dozen of its images. It
/// reports every serious finding of inspect(), and odd intrinsics, to `diagnostics` under its kind. If axes,
/// units or extrinsics are so wrong that no estimate can be correct, it also reports kSensorsContradict. A
/// rig at rest gives no findings. `data`: name of the recording for the messages. Readings in another unit,
/// which the run converts, are reported as "gyroscope_unit" and "accelerometer_unit".
StartCheck checkStart(const SourceFactory& open, const std::string& data, const StartCheckOptions& options,
                      Diagnostics* diagnostics);

}  // namespace lodeline

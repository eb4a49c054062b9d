#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/odometry.h"
#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

/// Everything that `lodeline run` can be told.
struct RunSettings {
  EurocOptions source;
  SynchronizerOptions synchronizer;
  OdometryOptions odometry;
  std::string magnetometer_calibration;  ///< file of `lodeline calibrate magnetometer`; empty for none
  std::vector<double> site;              ///< latitude, longitude (degrees) and height (m); empty for unknown
  std::string date;                      ///< YYYY-MM-DD; empty for unknown
  WhiteNoise shown_noise;                ///< of the IMU, by its readings; what its file says is held to it
};

void bindRunSettings(Settings* settings, RunSettings* options);

/// The Earth's field where and when the recording was made, for true north; nothing where neither is told.
/// Throws UsageError where one is told without the other, or the site is no place.
std::optional<Vec3> siteField_W(const RunSettings& options);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

/// All settings of `lodeline run`.
struct RunSettings {
  EurocOptions source;
  int image_step = 1;  ///< every Nth image is used
  SynchronizerOptions synchronizer;
  OdometryOptions odometry;
  std::string magnetometer_calibration;  ///< file of `lodeline calibrate magnetometer`; empty for none
  std::vector<double> site;              ///< latitude, longitude (degrees) and height (m); empty for unknown
  std::string date;                      ///< YYYY-MM-DD; empty for unknown
  WhiteNoise
      shown_noise;    ///< of the IMU, estimated from its readings; used to check the noise stated in its file
  bool loops = true;  ///< find loops, and write the map of the dive
  double tag_size_m = 0.0;   ///< edge of AprilTags on the line; 0: unknown
  std::string tags_control;  ///< file of control points that names tags; empty for none
};

void bindRunSettings(Settings* settings, RunSettings* options);

/// The Earth's field at the site and date of the recording, for true north; empty where neither is given.
/// Throws UsageError where only one is given, or the site is not a valid position.
std::optional<Vec3> siteField_W(const RunSettings& options);

}  // namespace lodeline

#include "apps/lodeline/compare/azimuth_method.h"

#include <cmath>

#include "lodeline/ahrs/magnetometer_readings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/azimuth_correction.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

/// All readings of the recording on the IMU's clock, corrected, in body axes.
std::vector<StampedField> readField(const RunRequest& request, const RunSettings& options) {
  Diagnostics diagnostics;
  EurocOptions source_options = options.source;
  source_options.with_cameras = false;
  source_options.camera_indices.clear();
  source_options.rig_files.assign(request.bag.rig_files.begin(), request.bag.rig_files.end());
  EurocSource source(request.data, source_options, &diagnostics);
  Rig rig = source.rig();
  if (!options.magnetometer_calibration.empty()) {
    applyCalibration(readCalibrationFile(options.magnetometer_calibration), options.magnetometer_calibration,
                     &rig);
  }
  if (!rig.magnetometer || !rig.magnetometer->is_calibrated) {
    throw InputError(request.data +
                     ": method azimuth takes a calibrated magnetometer; give --mag-calibration");
  }
  const Duration offset = Duration::fromSeconds(rig.magnetometer->time_offset_to_imu_s);
  std::vector<MagnetometerSample> samples;
  while (const std::optional<MagnetometerSample> sample = source.nextMagnetometer()) {
    if (!samples.empty() && sample->time + offset <= samples.back().time) continue;
    samples.push_back({sample->time + offset, sample->field_M});
  }
  std::vector<StampedField> field;
  for (const FieldSample& sample : MagnetometerReadings(*rig.magnetometer, &diagnostics).add(samples)) {
    field.push_back({sample.time, sample.field_B});
  }
  return field;
}

}  // namespace

Trajectory makeAzimuthRun(const RunRequest& request, const Trajectory& odometry,
                          const std::filesystem::path& folder) {
  RunSettings options;
  Settings settings;
  applyRequest(request, &settings, &options);
  AzimuthCorrectionOptions correction;
  if (const std::optional<Vec3> site_field_W = siteField_W(options)) {
    correction.field_azimuth_rad = std::atan2(site_field_W->x(), site_field_W->y());
  }
  const Trajectory corrected = correctHeadingByAzimuth(odometry, readField(request, options), correction);
  createOutputFolder(folder);
  writeTum(corrected, folder / "trajectory.tum");
  return corrected;
}

}  // namespace lodeline

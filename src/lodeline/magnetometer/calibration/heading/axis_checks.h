#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/calibration/heading/field_alignment.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// Tests whether gyroscope, accelerometer and field measure the same rotations. The field (corrected, in
/// units of its magnitude) and gravity have constant directions in the world. Both must therefore rotate
/// relative to the body as the gyroscope measures, and gravity must do so in the gyroscope's own axes.
/// Returns a description of the problem; nothing where all agree or the motion is insufficient. Wrong signs
/// or a wrong order of axes that keep the gyroscope's frame right-handed appear in gravity alone. Those that
/// mirror it also appear in the field.
std::optional<std::string> gyroscopeObjection(std::span<const NormalizedFieldSample> field,
                                              const FieldAlignment& alignment,
                                              std::span<const ImuSample> imu);

/// Reports `magnetometer_reversed` for a measured dip (rad, below the horizon) that is clearly negative. Call
/// it where no site determines the hemisphere.
void reportNegativeDip(double dip_rad, Diagnostics* diagnostics);

/// Checks the sign of the measured dip and the estimated rotation. Mirrored axes (exchanged, or one or three
/// signs reversed) appear as right-handed axes with the field reversed (alignField). The dip then has the
/// sign of the other hemisphere. Throws EstimationError where the field at the site proves this; without a
/// site, see reportNegativeDip(). Reports `magnetometer_rotation` where the rotation differs greatly from
/// that stated in the recording.
void checkAxes(const MagnetometerFit& fit, const std::optional<Vec3>& site_field_ENU,
               const std::optional<Quat>& stated_body_from_magnetometer, Diagnostics* diagnostics);

}  // namespace lodeline

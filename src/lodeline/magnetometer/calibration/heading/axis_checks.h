#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/field_alignment.h"
#include "lodeline/magnetometer/iron/magnetometer_fit.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Whether gyroscope, accelerometer and field turn alike. The field (corrected, in units of its size) and
/// gravity keep their direction in the world, so both must turn against the body as the gyroscope says, and
/// gravity must do so in the gyroscope's own axes. Gives what is wrong in words; nothing where all agree or
/// the motion does not tell. A sign or an order of axes that keeps the gyroscope's frame right-handed shows
/// in gravity alone; one that mirrors it shows in the field as well.
std::optional<std::string> gyroscopeObjection(std::span<const NormalizedFieldSample> field,
                                              const FieldAlignment& alignment,
                                              std::span<const ImuSample> imu);

/// Reports `magnetometer_reversed` for a measured dip (rad, below the horizon) that is clearly negative: to
/// be called where no site tells the hemisphere.
void reportNegativeDip(double dip_rad, Diagnostics* diagnostics);

/// Judges the sign of the measured dip and the rotation found. Mirrored axes (exchanged, or one or three
/// signs reversed) come out as right-handed ones with the field reversed (alignField), so the dip has the
/// sign of the other hemisphere. Throws EstimationError where the field at the site says that it is so;
/// without a site, see reportNegativeDip(). Reports `magnetometer_rotation` where the rotation is far from
/// the one that the recording states.
void checkAxes(const MagnetometerFit& fit, const std::optional<Vec3>& site_field_ENU,
               const std::optional<Quat>& stated_body_from_magnetometer, Diagnostics* diagnostics);

}  // namespace lodeline

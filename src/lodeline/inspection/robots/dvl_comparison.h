#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/inertial_path.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Consistency of a DVL with the IMU. Within windows of seconds, velocities in axes of the window's start
/// must change as the integral of the specific force does. A constant and gravity, which grows with time, are
/// free:
///
///     R_k v_k = v_0 + F_k + g t_k
///
/// with the attitude R_k by the gyroscope and the integral F_k of the specific force. The remainder is what
/// is left after the best v_0 and g of each window.
struct DvlComparison {
  int pings = 0;
  double motion_m_per_s = 0.0;          ///< rms of the change of velocity by the IMU
  double remainder_m_per_s = 0.0;       ///< rms, with the axes as recorded
  double best_remainder_m_per_s = 0.0;  ///< with the best permutation of body axes
  Mat3 best_axes = Mat3::Identity();    ///< true from given
  double time_offset_s = 0.0;           ///< stamps + this = clock of the IMU, at the smallest remainder
  double remainder_at_offset_m_per_s = 0.0;
};

/// Nothing where there are too few pings with a velocity.
std::optional<DvlComparison> compareDvl(const std::vector<DvlSample>& pings, const DvlCalibration& dvl,
                                        const InertialPath& path);

/// The velocity of a ping: as stated, or of three beams or more by least squares.
std::optional<Vec3> velocityOf(const DvlSample& ping, const DvlCalibration& dvl);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/inspection/survey/inertial_path.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Field of one ampere, as the readings show it.
struct ChannelField {
  std::string name;
  Vec3 field_T_per_A = Vec3::Zero();  ///< in axes of the magnetometer
  double sigma_T_per_A = 0.0;         ///< of each axis
};

/// Consistency of currents with the magnetometer. Within windows of seconds, the field turned back by the
/// gyroscope is constant, apart from hard iron h and fields k_i of currents:
///
///     R_k m_k = m_0 + R_k (h + sum_i k_i I_i,k)
///
/// All windows share h and the k_i, which are the least-squares solution.
struct CurrentComparison {
  int readings = 0;
  double scatter_T = 0.0;              ///< rms of the remainder without currents
  double explained_scatter_T = 0.0;    ///< with them
  std::vector<ChannelField> channels;  ///< without channels whose current hardly changes
  double time_offset_s = 0.0;  ///< stamps of currents + this = clock of the IMU, at the smallest scatter
  double scatter_at_offset_T = 0.0;
};

/// `tesla_per_unit`: of the readings of the magnetometer. Nothing where there are too few readings of both,
/// or no current changes.
std::optional<CurrentComparison> compareCurrents(const std::vector<MagnetometerSample>& field,
                                                 const std::vector<CurrentSample>& currents, const Rig& rig,
                                                 double tesla_per_unit, const InertialPath& path);

}  // namespace lodeline

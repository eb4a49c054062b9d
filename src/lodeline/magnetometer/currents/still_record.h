#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Readings of a vehicle that rests or is held while its channels of current run up and down.
struct StillTest {
  std::vector<std::string> channels;
  std::vector<MagnetometerSample> magnetometer;  ///< T, raw
  std::vector<CurrentSample> currents;
  std::vector<ImuSample> imu;           ///< empty where there are none
  MagnetometerCalibration calibration;  ///< iron, mounting and lag, as far as they are known
};

/// A still test on common times: means over equal numbers of magnetometer readings. Fields are in microtesla
/// so that all columns of a least-squares problem have similar sizes.
struct TestTable {
  Eigen::VectorXd times_s;      ///< of the magnetometer's clock, from the first reading
  Time begin;                   ///< stamp of the first reading
  Eigen::MatrixXd readings_uT;  ///< a row for each mean
  Eigen::MatrixXd baseline;     ///< columns of the slow part, linear between knots
  Eigen::MatrixXd rotation_B;   ///< rad, three columns beside the baseline; no column without gyroscope
  /// Changes of the heading, rad/uT of a change of the raw reading.
  Vec3 heading_by_reading = Vec3::Zero();
  bool is_level_known = false;  ///< from the accelerometer; else a dip of 60 degrees is assumed

  /// Currents at the times minus a lag, A; rows without a known current are NaN.
  Eigen::MatrixXd currentsAt(const StillTest& test, double lag_s) const;
  double duration_s() const { return times_s[times_s.size() - 1]; }
};

/// Screens the magnetometer's readings (screenReadings) and tabulates the test. Throws EstimationError where
/// magnetometer or currents have too few readings in common times.
TestTable tabulate(const StillTest& test, Diagnostics* diagnostics);

}  // namespace lodeline

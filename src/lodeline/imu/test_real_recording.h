#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lodeline/imu/propagation.h"

namespace lodeline {

/// Readings and true states of a EuRoC recording, for tests on real data.
struct RealRecording {
  std::vector<ImuSample> readings;
  std::vector<NavigationState> truth;

  /// Readings from one moment to another, interpolated at both ends.
  std::vector<ImuSample> readingsBetween(Time from, Time to) const;
};

/// Reads gzipped EuRoC CSV files of the IMU and of the ground truth.
RealRecording readRealRecording(const std::filesystem::path& imu_csv_gz,
                                const std::filesystem::path& truth_csv_gz);

}  // namespace lodeline

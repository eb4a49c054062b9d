#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "lodeline/imu/propagation.h"

namespace lodeline {

/// For tests on real data: the readings and the true states of a EuRoC recording.
struct RealRecording {
  std::vector<ImuSample> readings;
  std::vector<NavigationState> truth;

  /// Readings from one moment to another, those at the borders interpolated.
  std::vector<ImuSample> readingsBetween(Time from, Time to) const;
};

/// From gzipped EuRoC CSV files of the IMU and of the ground truth.
RealRecording readRealRecording(const std::filesystem::path& imu_csv_gz,
                                const std::filesystem::path& truth_csv_gz);

}  // namespace lodeline

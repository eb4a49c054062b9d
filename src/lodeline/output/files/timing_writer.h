#pragma once

#include <chrono>
#include <filesystem>
#include <fstream>

#include "lodeline/estimator/packet_odometry.h"

namespace lodeline {

/// Writes `timings.csv`: wall time of each frame from reading to writing, and processor time of front end,
/// estimator and pictures. It is a separate file because it differs from run to run.
class TimingWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit TimingWriter(const std::filesystem::path& folder);

  /// To be called once all work of a frame is done. `times`, `pictures_s`: of all frames so far.
  void write(Time time, const StageTimes& times, double pictures_s);

 private:
  using Clock = std::chrono::steady_clock;

  std::ofstream stream_;
  Clock::time_point last_ = Clock::now();
  StageTimes before_;
  double pictures_before_s_ = 0.0;
};

}  // namespace lodeline

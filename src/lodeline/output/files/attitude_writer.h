#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/ahrs/attitude_filter.h"

namespace lodeline {

/// Azimuth of the body's x axis: clockwise from north, 0 to 360 degrees.
double azimuth_deg(const Quat& world_from_body);

/// Writes `attitude.csv` (orientation, heading, its sigma, status, bias) and `attitude.tum` (with position
/// zero), one line per estimate, and collects the values of the summary.
class AttitudeWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit AttitudeWriter(const std::filesystem::path& folder);

  void write(const AttitudeEstimate& estimate);
  /// Throws InputError where something could not be written.
  void finish();

  int count() const { return count_; }
  /// Summary for people: length, shares of each status, last heading and bias. `north`: "magnetic north" or
  /// the like.
  std::string text(const std::string& north) const;
  nlohmann::ordered_json json(const std::string& north) const;

 private:
  std::filesystem::path folder_;
  std::ofstream csv_, tum_;
  int count_ = 0;
  int at_rest_ = 0;
  std::map<HeadingStatus, int> statuses_;
  std::optional<Time> first_;
  AttitudeEstimate last_;
};

}  // namespace lodeline

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/ahrs/reading_unit.h"
#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Selects the usable readings of a magnetometer and corrects them for soft and hard iron, in tesla and body
/// axes. It drops the others and reports each kind once:
/// - `magnetometer_invalid`: not a number, infinite, or zero;
/// - `magnetometer_repeated`: the same three values as before, from a driver that polls faster than the
///   sensor measures;
/// - `magnetometer_frozen`: only repetitions for a second;
/// - `magnetometer_saturated`: an axis at the end of its range;
/// - `magnetometer_converted`, `magnetometer_unusable`: readings are not in tesla but in a unit that
///   ReadingUnit identifies, or in an unknown unit; the latter are all dropped.
class MagnetometerReadings {
 public:
  /// `diagnostics` must outlive the readings.
  MagnetometerReadings(const MagnetometerCalibration& calibration, Diagnostics* diagnostics)
      : calibration_(calibration), unit_(calibration), diagnostics_(diagnostics) {}

  /// Usable readings among the next ones, which must be in order of time.
  std::vector<FieldSample> add(std::span<const MagnetometerSample> readings);

  /// Whether there were only repetitions for the last second or longer.
  bool frozen() const { return frozen_; }

 private:
  void findUnit(std::span<const MagnetometerSample> readings);
  bool isNew(const MagnetometerSample& reading);
  bool isSaturated(const Vec3& field_M);
  void report(const std::string& kind, const std::string& message) const;

  MagnetometerCalibration calibration_;
  ReadingUnit unit_;
  Diagnostics* diagnostics_;
  std::optional<MagnetometerSample> last_new_;
  bool frozen_ = false;
  /// Constant value of an axis, its number of readings, and the field magnitude in that time.
  struct Plateau {
    double value_T = 0.0;
    int readings = 0;
    double least_size_T = 0.0, most_size_T = 0.0;
  };
  Plateau plateaus_[3];
  double limit_T_ = 1e9;  ///< detected end of the range
};

}  // namespace lodeline

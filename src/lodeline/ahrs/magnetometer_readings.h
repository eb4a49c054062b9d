#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/ahrs/reading_unit.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Sorts a magnetometer's readings: what can be used comes out freed from soft and hard iron, in tesla and
/// body axes; what cannot is left out and said once a kind:
/// - `magnetometer_invalid`: not a number, infinite, or zero;
/// - `magnetometer_repeated`: the same three figures as before, as a driver gives them that is asked faster
///   than the sensor measures;
/// - `magnetometer_frozen`: nothing but repetition for a second;
/// - `magnetometer_saturated`: an axis at the end of its range;
/// - `magnetometer_converted`, `magnetometer_unusable`: readings are not in tesla but in a unit that
///   ReadingUnit finds, or in none, and then of no use and all left out.
class MagnetometerReadings {
 public:
  /// `diagnostics` must outlive the readings.
  MagnetometerReadings(const MagnetometerCalibration& calibration, Diagnostics* diagnostics)
      : calibration_(calibration), unit_(calibration), diagnostics_(diagnostics) {}

  /// The usable ones among the next readings, which are in order of time.
  std::vector<FieldSample> add(std::span<const MagnetometerSample> readings);

  /// Whether the last readings were nothing but repetition, for a second or longer.
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
  /// The value that an axis has stuck to, since how many readings, and the size of the field meanwhile.
  struct Plateau {
    double value_T = 0.0;
    int readings = 0;
    double least_size_T = 0.0, most_size_T = 0.0;
  };
  Plateau plateaus_[3];
  double limit_T_ = 1e9;  ///< of the range, once it was reached
};

}  // namespace lodeline

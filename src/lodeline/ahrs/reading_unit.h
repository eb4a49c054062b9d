#pragma once

#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/geometry/types.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// The unit of a magnetometer's readings, by the size that the field then has: the Earth's has 22 to 67 uT,
/// and the units lie a decade or more apart. Judged by the first readings together, so that a wild one among
/// them misleads for two readings at most; further ones change nothing.
class ReadingUnit {
 public:
  /// The calibration's hard iron can be larger than the field; its figures are in tesla.
  explicit ReadingUnit(const MagnetometerCalibration& calibration) : calibration_(calibration) {}

  /// A reading as recorded, finite.
  void add(const Vec3& reading);

  /// Whether enough readings were seen for the unit to stay.
  bool settled() const;
  /// Raw before the first reading, and where no unit fits.
  FieldUnit unit() const { return unit_; }
  /// Median size of the readings seen, as recorded.
  double size() const;

 private:
  FieldUnit find() const;
  bool fits(FieldUnit unit) const;

  MagnetometerCalibration calibration_;
  std::vector<Vec3> readings_;
  FieldUnit unit_ = FieldUnit::Raw;
};

}  // namespace lodeline

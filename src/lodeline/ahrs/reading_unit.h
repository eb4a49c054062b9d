#pragma once

#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Unit of a magnetometer's readings, determined from the field magnitude: the Earth's field has 22 to 67 uT,
/// and the units differ by a decade or more. The first readings decide together, so that one outlier among
/// them affects at most two readings. Later readings do not change the unit.
class ReadingUnit {
 public:
  /// The calibration, in tesla, is needed because its hard iron can exceed the field.
  explicit ReadingUnit(const MagnetometerCalibration& calibration) : calibration_(calibration) {}

  /// A reading as recorded, finite.
  void add(const Vec3& reading);

  /// Whether enough readings were seen for the unit to stay.
  bool settled() const;
  /// Raw before the first reading, and where no unit fits.
  FieldUnit unit() const { return unit_; }
  /// Median magnitude of the readings seen, in the recorded unit.
  double size() const;

 private:
  FieldUnit find() const;
  bool fits(FieldUnit unit) const;

  MagnetometerCalibration calibration_;
  std::vector<Vec3> readings_;
  FieldUnit unit_ = FieldUnit::Raw;
};

}  // namespace lodeline

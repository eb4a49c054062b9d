#include "lodeline/ahrs/magnetometer_readings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

bool isMeasured(const MagnetometerSample& reading) {
  return reading.field_M.allFinite() && !reading.field_M.isZero(0.0);
}

}  // namespace

void MagnetometerReadings::report(const std::string& kind, const std::string& message) const {
  diagnostics_->report(Severity::Warning, "magnetometer_" + kind, "magnetometer: " + message);
}

void MagnetometerReadings::findUnit(std::span<const MagnetometerSample> readings) {
  if (unit_.settled()) return;
  for (const MagnetometerSample& reading : readings) {
    if (isMeasured(reading)) unit_.add(reading.field_M);
  }
  if (!unit_.settled() || unit_.unit() == FieldUnit::Tesla) return;
  if (unit_.unit() == FieldUnit::Raw) {
    report("unusable",
           fmt::format("readings of {:.3g} fit the Earth's field (22 to 67 uT) in no unit; the magnetometer "
                       "is not used",
                       unit_.size()));
    return;
  }
  report("converted", fmt::format("readings of {:.3g} can only be {}, not T; they are converted. Convert the "
                                  "recording, and any calibration made from it, to be safe",
                                  unit_.size(), toString(unit_.unit())));
}

bool MagnetometerReadings::isNew(const MagnetometerSample& reading) {
  constexpr double kFrozen_s = 1.0;
  if (!last_new_ || reading.field_M != last_new_->field_M) {
    last_new_ = reading;
    frozen_ = false;
    return true;
  }
  diagnostics_->report(Severity::Notice, "magnetometer_repeated",
                       "magnetometer: readings that repeat the one before are left out");
  if (!frozen_ && (reading.time - last_new_->time).seconds() > kFrozen_s) {
    frozen_ = true;
    report("frozen", fmt::format("nothing but the same reading from {} ns on; left out until it changes",
                                 last_new_->time.nanoseconds()));
  }
  return false;
}

bool MagnetometerReadings::isSaturated(const Vec3& field_M) {
  // An axis is at the end of its range if it keeps its value exactly over many readings while the field
  // magnitude seems to change. A coarse sensor that rotates about one of its axes also keeps the value of
  // that axis, but the field magnitude then stays constant.
  constexpr int kReadings = 10;
  constexpr double kSizeRatio = 1.1;
  const double size_T = calibration_.corrected_B(field_M).norm();
  for (int axis = 0; axis < 3; ++axis) {
    Plateau& plateau = plateaus_[axis];
    if (plateau.value_T != field_M[axis]) plateau = {field_M[axis], 0, size_T, size_T};
    ++plateau.readings;
    plateau.least_size_T = std::min(plateau.least_size_T, size_T);
    plateau.most_size_T = std::max(plateau.most_size_T, size_T);
    if (plateau.readings >= kReadings && plateau.most_size_T > kSizeRatio * plateau.least_size_T)
      limit_T_ = std::min(limit_T_, std::abs(field_M[axis]));
  }
  return field_M.cwiseAbs().maxCoeff() >= limit_T_;
}

std::vector<FieldSample> MagnetometerReadings::add(std::span<const MagnetometerSample> readings) {
  std::vector<FieldSample> usable;
  findUnit(readings);
  for (const MagnetometerSample& reading : readings) {
    if (!isMeasured(reading)) {
      report("invalid",
             fmt::format("reading at {} ns is zero or no number; left out", reading.time.nanoseconds()));
      continue;
    }
    if (unit_.unit() == FieldUnit::Raw || !isNew(reading)) continue;
    const Vec3 field_M = teslaPer(unit_.unit()) * reading.field_M;
    if (isSaturated(field_M)) {
      report("saturated",
             fmt::format("an axis reached the end of its range of {:.4g} uT at {} ns; such readings "
                         "are left out",
                         1e6 * limit_T_, reading.time.nanoseconds()));
      continue;
    }
    usable.push_back({reading.time, calibration_.corrected_B(field_M)});
  }
  return usable;
}

}  // namespace lodeline

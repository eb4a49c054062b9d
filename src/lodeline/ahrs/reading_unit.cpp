#include "lodeline/ahrs/reading_unit.h"

#include <array>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr size_t kReadings = 20;
constexpr std::array kLargestFirst = {FieldUnit::Tesla, FieldUnit::Gauss, FieldUnit::Microtesla,
                                      FieldUnit::Milligauss, FieldUnit::Nanotesla};

template <typename Size>
double medianSize(const std::vector<Vec3>& readings, const Size& size) {
  std::vector<double> sizes;
  for (const Vec3& reading : readings) sizes.push_back(size(reading));
  return median(std::move(sizes));
}

}  // namespace

void ReadingUnit::add(const Vec3& reading) {
  if (settled()) return;
  readings_.push_back(reading);
  unit_ = find();
}

bool ReadingUnit::settled() const { return readings_.size() >= kReadings; }

double ReadingUnit::size() const {
  return readings_.empty() ? 0.0 : medianSize(readings_, [](const Vec3& reading) { return reading.norm(); });
}

bool ReadingUnit::fits(FieldUnit unit) const {
  const double tesla = teslaPer(unit);
  // If the unit is too small, the readings are negligible and only the calibration's hard iron remains.
  const double raw_T = tesla * size();
  if (raw_T < 5e-6 || raw_T > 500e-6) return false;
  const double corrected_T = medianSize(
      readings_, [&](const Vec3& reading) { return calibration_.corrected_B(tesla * reading).norm(); });
  return unitBySize(corrected_T) == FieldUnit::Tesla;
}

FieldUnit ReadingUnit::find() const {
  for (const FieldUnit unit : kLargestFirst) {
    if (fits(unit)) return unit;
  }
  // The calibration may be wrong, or missing where hard iron exceeds the field. The uncorrected magnitude
  // then decides. Only readings in tesla are this small.
  if (size() > 1e-6 && size() < 1e-3) return FieldUnit::Tesla;
  return unitBySize(size());
}

}  // namespace lodeline

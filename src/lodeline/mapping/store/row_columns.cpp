#include "lodeline/mapping/store/row_columns.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

namespace lodeline {
namespace {

constexpr double kUnitRotation = 1e-6;  ///< deviation of a quaternion's length

}  // namespace

InputError withName(const Database& database, const char* table, int64_t row, const InputError& error) {
  const std::string file = database.path().string() + ": ";
  std::string_view reason = error.what();
  if (reason.starts_with(file)) reason.remove_prefix(file.size());
  return InputError(fmt::format("{}{} {}: {}", file, table, row, reason));
}

void bindFinite(double value, Query* query) {
  if (!std::isfinite(value)) throw InputError("a number is not finite");
  query->real(value);
}

double finiteAt(const Query& query, int column) {
  const double value = query.realAt(column);
  if (query.isNull(column) || !std::isfinite(value)) throw InputError("a number is missing or not finite");
  return value;
}

void bindPoint(const Vec3& point, Query* query) {
  for (const double coordinate : point) bindFinite(coordinate, query);
}

Vec3 pointAt(const Query& query, int column) {
  return Vec3(finiteAt(query, column), finiteAt(query, column + 1), finiteAt(query, column + 2));
}

void bindPose(const Rigid3& pose, Query* query) {
  bindPoint(pose.translation, query);
  if (!(std::abs(pose.rotation.norm() - 1.0) < kUnitRotation)) throw InputError("a rotation is not unit");
  const double sign = pose.rotation.w() < 0.0 ? -1.0 : 1.0;
  for (const double coordinate : pose.rotation.coeffs()) bindFinite(sign * coordinate, query);
}

Rigid3 poseAt(const Query& query, int column) {
  const Quat rotation(finiteAt(query, column + 6), finiteAt(query, column + 3), finiteAt(query, column + 4),
                      finiteAt(query, column + 5));
  if (!(std::abs(rotation.norm() - 1.0) < kUnitRotation)) throw InputError("a rotation is not unit");
  return Rigid3(rotation, pointAt(query, column));
}

}  // namespace lodeline

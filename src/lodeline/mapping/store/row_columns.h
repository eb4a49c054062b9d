#pragma once

#include "lodeline/mapping/store/map_records.h"
#include "lodeline/mapping/store/sqlite/database.h"

/// Groups of columns that several tables of a map have. Writing throws InputError for values that no map can
/// hold, reading for values that no map has.
namespace lodeline {

/// Columns x, y, z, qx, qy, qz, qw.
void bindPose(const Rigid3& pose, Query* query);
Rigid3 poseAt(const Query& query, int column);
constexpr int kPoseColumns = 7;

void bindPoint(const Vec3& point, Query* query);
Vec3 pointAt(const Query& query, int column);

/// A column of a finite number.
void bindFinite(double value, Query* query);
double finiteAt(const Query& query, int column);

/// The error with the names of the file and the row before its message.
InputError withName(const Database& database, const char* table, int64_t row, const InputError& error);

/// Runs `use`. An InputError gets the names of the file and the row.
template <typename Use>
auto withRowName(const Database& database, const char* table, int64_t row, const Use& use) {
  try {
    return use();
  } catch (const InputError& error) {
    throw withName(database, table, row, error);
  }
}

}  // namespace lodeline

#pragma once

#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {

/// Version of the schema, `PRAGMA user_version`.
constexpr int kMapSchemaVersion = 1;
/// "LODE", `PRAGMA application_id`.
constexpr int kMapApplicationId = 0x4c4f4445;

/// Makes the tables of an empty database, in the transaction that is open.
void createMapTables(Database* database);

/// Throws InputError where the database is not a map of this version.
void checkMapVersion(Database* database);

}  // namespace lodeline

#pragma once

#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {

/// Version of the schema, `PRAGMA user_version`. Version 2 added the table field.
constexpr int kMapSchemaVersion = 2;
/// "LODE", `PRAGMA application_id`.
constexpr int kMapApplicationId = 0x4c4f4445;

/// Makes the tables of an empty database, in the transaction that is open.
void createMapTables(Database* database);

/// Throws InputError where the database is not a map, or one of a newer version. An older map becomes one of
/// this version where the database can be changed. Otherwise, empty temporary tables take the place of those
/// that it lacks.
void checkMapVersion(Database* database);

}  // namespace lodeline

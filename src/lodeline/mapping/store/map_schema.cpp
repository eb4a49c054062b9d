#include "lodeline/mapping/store/map_schema.h"

#include <fmt/format.h>

namespace lodeline {
namespace {

// docs/reference/map-file.md describes every column.
constexpr const char* kTables = R"(
CREATE TABLE map (
  key TEXT NOT NULL PRIMARY KEY,
  value TEXT NOT NULL
);
CREATE TABLE dive (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL UNIQUE CHECK (length(name) > 0),
  recording TEXT NOT NULL,
  fingerprint TEXT NOT NULL,
  start_ns INTEGER NOT NULL,
  end_ns INTEGER,
  heading_reference TEXT NOT NULL,
  rig TEXT NOT NULL,
  corrections TEXT NOT NULL,
  depth_reference TEXT NOT NULL,
  field_reference TEXT NOT NULL,
  settings_digest TEXT NOT NULL
);
CREATE TABLE keyframe (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  dive INTEGER NOT NULL REFERENCES dive (id) ON DELETE CASCADE,
  time_ns INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  covariance BLOB NOT NULL,
  north_from_odom_rad REAL NOT NULL,
  heading_sigma_rad REAL,
  depth_m REAL,
  depth_sigma_m REAL
);
CREATE INDEX keyframe_by_dive ON keyframe (dive);
CREATE TABLE features (
  keyframe INTEGER PRIMARY KEY REFERENCES keyframe (id) ON DELETE CASCADE,
  count INTEGER NOT NULL,
  data BLOB NOT NULL
);
CREATE TABLE solution (
  keyframe INTEGER PRIMARY KEY REFERENCES keyframe (id) ON DELETE CASCADE,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  covariance BLOB NOT NULL
);
CREATE TABLE edge (
  new_keyframe INTEGER NOT NULL REFERENCES keyframe (id) ON DELETE CASCADE,
  old_keyframe INTEGER NOT NULL REFERENCES keyframe (id) ON DELETE CASCADE,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  covariance BLOB NOT NULL,
  PRIMARY KEY (new_keyframe, old_keyframe)
) WITHOUT ROWID;
CREATE INDEX edge_by_old ON edge (old_keyframe);
CREATE TABLE loop (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  old_keyframe INTEGER NOT NULL REFERENCES keyframe (id) ON DELETE CASCADE,
  new_keyframe INTEGER NOT NULL REFERENCES keyframe (id) ON DELETE CASCADE,
  source TEXT NOT NULL,
  status TEXT NOT NULL,
  reason TEXT NOT NULL,
  matches INTEGER NOT NULL,
  inliers INTEGER NOT NULL,
  covered_share REAL NOT NULL,
  rms_sigmas REAL NOT NULL,
  mahalanobis_squared REAL NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  qx REAL NOT NULL, qy REAL NOT NULL, qz REAL NOT NULL, qw REAL NOT NULL,
  covariance BLOB NOT NULL,
  inlier_matches BLOB NOT NULL
);
CREATE INDEX loop_by_old ON loop (old_keyframe);
CREATE INDEX loop_by_new ON loop (new_keyframe);
CREATE TABLE control_point (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL UNIQUE CHECK (length(name) > 0),
  kind TEXT NOT NULL,
  tag INTEGER,
  x REAL, y REAL, z REAL,
  covariance BLOB,
  origin TEXT NOT NULL
);
CREATE TABLE control_observation (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  point INTEGER NOT NULL REFERENCES control_point (id) ON DELETE CASCADE,
  keyframe INTEGER NOT NULL REFERENCES keyframe (id) ON DELETE CASCADE,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  covariance BLOB NOT NULL
);
CREATE INDEX control_observation_by_point ON control_observation (point);
CREATE INDEX control_observation_by_keyframe ON control_observation (keyframe);
)";

// Of a TABLE or TEMP TABLE. A temporary table cannot refer to a table of the file.
constexpr const char* kFieldTable = R"(
CREATE {} field (
  keyframe INTEGER PRIMARY KEY{},
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  sigma REAL NOT NULL
);
)";

constexpr int kFirstVersion = 1;

std::string fieldTable() {
  return fmt::format(kFieldTable, "TABLE", " REFERENCES keyframe (id) ON DELETE CASCADE");
}

void setVersion(Database* database) {
  database->run(fmt::format("PRAGMA user_version = {}", kMapSchemaVersion).c_str());
}

/// Adds what later versions have, in one transaction.
void upgrade(Database* database) {
  database->run("BEGIN IMMEDIATE");
  try {
    // Another program may have done it in the meantime.
    if (database->number("PRAGMA user_version") < kMapSchemaVersion) {
      database->run(fieldTable().c_str());
      setVersion(database);
    }
    database->run("COMMIT");
  } catch (const InputError&) {
    if (database->inTransaction()) database->run("ROLLBACK");
    throw;
  }
}

}  // namespace

void createMapTables(Database* database) {
  database->run(kTables);
  database->run(fieldTable().c_str());
  database->run(fmt::format("PRAGMA application_id = {}", kMapApplicationId).c_str());
  setVersion(database);
}

void checkMapVersion(Database* database) {
  const std::string file = database->path().string();
  const int64_t application = database->number("PRAGMA application_id");
  const int64_t version = database->number("PRAGMA user_version");
  if (application != kMapApplicationId)
    throw InputError(fmt::format("{}: is a database of another program, no map", file));
  if (version > kMapSchemaVersion) {
    throw InputError(
        fmt::format("{}: is a map of version {}, and this program knows maps up to version {}; "
                    "use a newer program",
                    file, version, kMapSchemaVersion));
  }
  if (version < kFirstVersion) {
    throw InputError(fmt::format("{}: is a map of version {}, older than the first one ({}); build it again",
                                 file, version, kFirstVersion));
  }
  if (version == kMapSchemaVersion) return;
  if (database->isReadOnly()) {
    database->runOnTemporaryTables(fmt::format(kFieldTable, "TEMP TABLE", "").c_str());
  } else {
    upgrade(database);
  }
}

}  // namespace lodeline

#include "lodeline/mapping/store/map_file.h"

#include <fmt/format.h>

#include <stdexcept>

#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_rows.h"
#include "lodeline/mapping/store/map_schema.h"
#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {
namespace {

/// Bounds the pages that SQLite keeps in memory, by default 2 MB. A map is written once and read from its
/// beginning to its end, for which a few pages suffice.
void boundCache(Database* database) { database->run("PRAGMA cache_size = -256"); }  // KiB

/// The file for reading or changing, its version checked.
std::unique_ptr<Database> openedMap(const std::filesystem::path& file, MapFile::Access access) {
  auto database = std::make_unique<Database>(
      file, access == MapFile::Access::Read ? Database::Mode::Read : Database::Mode::Change);
  boundCache(database.get());
  checkMapVersion(database.get());
  if (access == MapFile::Access::Change)
    database->run("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  return database;
}

}  // namespace

MapFile::MapFile(std::filesystem::path path, std::unique_ptr<Database> database)
    : path_(std::move(path)), database_(std::move(database)) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;
MapFile::~MapFile() = default;

MapFile MapFile::create(const std::filesystem::path& file, const MapDescription& description) {
  if (!isUnfinishedMap(file)) throw InputError(fmt::format("{}: exists already", file.string()));
  auto database = std::make_unique<Database>(file, Database::Mode::Create);
  boundCache(database.get());
  database->run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;");
  MapFile map(file, std::move(database));
  MapChange change = map.change();
  // Another program may have created it in the meantime.
  if (map.database_->number("SELECT count(*) FROM sqlite_master") > 0)
    throw InputError(fmt::format("{}: exists already", file.string()));
  createMapTables(map.database_.get());
  change.setDescription(description);
  change.commit();
  return map;
}

MapFile MapFile::open(const std::filesystem::path& file, Access access) {
  return MapFile(file, openedMap(file, access));
}

MapFile MapFile::openOrCreate(const std::filesystem::path& file, const MapDescription& description) {
  if (isUnfinishedMap(file)) return create(file, description);
  return open(file, Access::Change);
}

MapDescription MapFile::description() const {
  MapDescription description;
  Query query = database_->query("SELECT key, value FROM map");
  GeodeticPosition site;
  int coordinates = 0;
  const auto take = [&](const std::string& value, double* number) {
    char* end = nullptr;
    *number = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != '\0')
      throw InputError(fmt::format("{}: the site's coordinate '{}' is no number", path_.string(), value));
    ++coordinates;
  };
  while (query.next()) {
    const std::string key = query.textAt(0), value = query.textAt(1);
    if (key == "frame") description.frame = value;
    if (key == "field_reference") description.field_reference = value;
    if (key == "site_latitude_deg") take(value, &site.latitude_deg);
    if (key == "site_longitude_deg") take(value, &site.longitude_deg);
    if (key == "site_height_m") take(value, &site.height_m);
  }
  if (coordinates == 3) description.site = site;
  return description;
}

std::vector<MapDive> MapFile::dives() const {
  std::vector<MapDive> dives;
  Query query = database_->query(rows::kSelectDives);
  while (query.next()) dives.push_back(rows::diveAt(query));
  return dives;
}

std::optional<MapDive> MapFile::findDive(const std::string& name) const {
  for (MapDive& dive : dives()) {
    if (dive.name == name) return std::move(dive);
  }
  return std::nullopt;
}

MapSizes MapFile::sizes() const {
  MapSizes sizes;
  const int64_t page_bytes = database_->number("PRAGMA page_size");
  sizes.file_bytes = static_cast<int64_t>(std::filesystem::file_size(path_));
  std::error_code is_missing;
  const auto log_bytes = std::filesystem::file_size(path_.string() + "-wal", is_missing);
  if (!is_missing) sizes.file_bytes += static_cast<int64_t>(log_bytes);
  sizes.free_bytes = page_bytes * database_->number("PRAGMA freelist_count");
  sizes.feature_bytes = database_->number("SELECT coalesce(sum(length(data)), 0) FROM features");
  sizes.features = database_->number("SELECT coalesce(sum(count), 0) FROM features");
  sizes.dives = database_->number("SELECT count(*) FROM dive");
  sizes.keyframes = database_->number("SELECT count(*) FROM keyframe");
  sizes.edges = database_->number("SELECT count(*) FROM edge");
  sizes.loops = database_->number("SELECT count(*) FROM loop");
  sizes.control_points = database_->number("SELECT count(*) FROM control_point");
  return sizes;
}

MapChange MapFile::change() {
  if (database_->inTransaction()) throw std::logic_error("a change of this map is open already");
  if (database_->isReadOnly())
    throw InputError(fmt::format("{}: cannot be changed, because it was opened for reading", path_.string()));
  database_->run("BEGIN IMMEDIATE");
  return MapChange(database_.get());
}

void MapFile::compact() {
  database_->run("VACUUM");
  database_->run("PRAGMA wal_checkpoint(TRUNCATE)");
}

}  // namespace lodeline

#include <fmt/format.h>

#include "lodeline/mapping/store/map_file.h"
#include "lodeline/mapping/store/map_rows.h"
#include "lodeline/mapping/store/pack/feature_block.h"
#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {
namespace {

constexpr size_t kMostFaults = 100;

/// Collects faults, so many and no more.
class Faults {
 public:
  void add(const std::string& kind, const std::string& text) {
    if (faults_.size() < kMostFaults) faults_.push_back({kind, text});
  }
  std::vector<MapFault> take() { return std::move(faults_); }

 private:
  std::vector<MapFault> faults_;
};

void checkSqlite(Database* database, Faults* faults) {
  Query integrity = database->query("PRAGMA integrity_check");
  while (integrity.next()) {
    if (integrity.textAt(0) != "ok") faults->add("map_damaged", integrity.textAt(0));
  }
  Query keys = database->query("PRAGMA foreign_key_check");
  while (keys.next()) {
    faults->add("map_reference", fmt::format("a row of {} refers to a row of {} that is missing",
                                             keys.textAt(0), keys.textAt(2)));
  }
}

/// Reads each row of a query with `read`.
template <typename Read>
void checkRows(Database* database, const char* table, const char* select, const Read& read, Faults* faults) {
  Query query = database->query(select);
  while (query.next()) {
    try {
      read(query);
    } catch (const InputError& error) {
      faults->add("map_row", fmt::format("{} {}: {}", table, query.integerAt(0), error.what()));
    }
  }
}

std::string withoutCondition(std::string select) {
  select.resize(select.find("WHERE"));
  return select;
}

void checkFeatureBlocks(Database* database, Faults* faults) {
  Query query = database->query("SELECT keyframe, count, data FROM features ORDER BY keyframe");
  while (query.next()) {
    try {
      const std::vector<MapFeature> features = unpackFeatures(query.blobAt(2));
      if (static_cast<int64_t>(features.size()) != query.integerAt(1)) {
        throw InputError(
            fmt::format("the row says {} features, the data has {}", query.integerAt(1), features.size()));
      }
    } catch (const InputError& error) {
      faults->add("map_features", fmt::format("keyframe {}: {}", query.integerAt(0), error.what()));
    }
  }
}

/// Matches of loops must be features that there are.
void checkLoopMatches(Database* database, Faults* faults) {
  Query query = database->query(
      "SELECT l.id, l.inlier_matches, coalesce(o.count, 0), coalesce(n.count, 0) FROM loop l "
      "LEFT JOIN features o ON o.keyframe = l.old_keyframe LEFT JOIN features n ON n.keyframe = "
      "l.new_keyframe");
  while (query.next()) {
    ByteReader reader(query.blobAt(1));
    bool is_good = reader.left() % 4 == 0;
    while (is_good && reader.left() > 0) {
      const int64_t old_feature = reader.integer<uint16_t>(), new_feature = reader.integer<uint16_t>();
      is_good = old_feature < query.integerAt(2) && new_feature < query.integerAt(3);
    }
    if (!is_good) {
      faults->add("map_loop",
                  fmt::format("loop {}: matches features that its keyframes lack", query.integerAt(0)));
    }
  }
}

}  // namespace

std::vector<MapFault> MapFile::check() const {
  Faults faults;
  Database* database = database_.get();
  try {
    checkSqlite(database, &faults);
    checkRows(database, "dive", rows::kSelectDives, rows::diveAt, &faults);
    checkRows(database, "keyframe", withoutCondition(rows::kSelectKeyframe).c_str(), rows::keyframeAt,
              &faults);
    checkRows(database, "edge from keyframe", withoutCondition(rows::kSelectEdges).c_str(), rows::edgeAt,
              &faults);
    checkRows(database, "loop", withoutCondition(rows::kSelectLoops).c_str(), rows::loopAt, &faults);
    checkRows(database, "control point", rows::kSelectPoints, rows::pointRowAt, &faults);
    checkRows(database, "observation of control point", rows::kSelectObservations, rows::observationAt,
              &faults);
    checkFeatureBlocks(database, &faults);
    checkLoopMatches(database, &faults);
    description();
  } catch (const InputError& error) {
    faults.add("map_damaged", error.what());
  }
  return faults.take();
}

}  // namespace lodeline

#include "lodeline/io/dives/profile_columns.h"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace lodeline {
namespace {

using Words = std::initializer_list<std::string_view>;

const Words kDepthWords = {"depth",      "tiefe",        "profondeur", "profundidad",
                           "profondita", "profundidade", "diepte",     "djup"};
const Words kTimeWords = {"time",     "elapsed", "timestamp", "stamp", "t",      "datetime", "runtime",
                          "divetime", "zeit",    "tauchzeit", "temps", "tiempo", "tempo",    "tijd"};
/// Words of depths other than that of the sample.
const Words kOtherDepths = {
    "average", "avg",   "mean", "max",      "maximum", "min",   "minimum", "stop",     "ceiling", "deco",
    "target",  "first", "next", "last",     "limit",   "mod",   "end",     "greatest", "planned", "plan",
    "error",   "sigma", "std",  "variance", "alarm",   "floor", "safety",  "maximale", "moyenne", "mittlere"};
/// Words of times other than that of the sample.
const Words kOtherTimes = {"max",  "maximum", "stop",   "surface", "tts",  "remaining", "first",  "gas",
                           "deco", "average", "ndl",    "next",    "last", "interval",  "offset", "total",
                           "zone", "bottom",  "ascent", "start",   "end",  "no"};

/// Clarity of a name: 0 if it does not match, 3 for a single word, 4 for that
/// of each sample.
int plainness(const ColumnName& name, Words wanted, Words others) {
  if (!name.hasWord(wanted) || name.hasWord(others)) return 0;
  if (name.hasWord({"sample"})) return 4;
  if (name.words.size() == 1 || name.hasWord({"elapsed"})) return 3;
  return name.hasWord({"dive", "run", "current", "water"}) || name.words.size() == 2 ? 2 : 1;
}

template <typename Score>
std::optional<size_t> best(const std::vector<ColumnName>& names, const Score& score) {
  std::optional<size_t> found;
  int most = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    const int points = score(names[i]);
    if (points <= most) continue;
    most = points;
    found = i;
  }
  return found;
}

}  // namespace

std::optional<ProfileColumns> profileColumns(const std::vector<ColumnName>& names) {
  const std::optional<size_t> depth =
      best(names, [](const ColumnName& name) { return plainness(name, kDepthWords, kOtherDepths); });
  if (!depth) return std::nullopt;
  ProfileColumns columns;
  columns.depth = *depth;
  columns.time = best(names, [](const ColumnName& name) {
    return name.hasWord(kDepthWords) ? 0 : plainness(name, kTimeWords, kOtherTimes);
  });
  columns.date = best(names, [](const ColumnName& name) {
    return plainness(name, {"date", "datum"}, kOtherTimes);
  });
  columns.dive = best(names, [](const ColumnName& name) {
    if (!name.hasWord({"dive"}) || name.hasWord(kTimeWords) || name.hasWord(kDepthWords)) return 0;
    return name.words.size() == 1 || name.hasWord({"number", "no", "nr", "id", "index"}) ? 1 : 0;
  });
  if (!columns.time) columns.time = columns.date;
  // A time since the start of the dive has no date.
  const bool is_clock =
      columns.time && !names[*columns.time].hasWord({"sample", "elapsed", "dive", "run", "runtime"});
  if (columns.time == columns.date || !is_clock) columns.date.reset();
  return columns;
}

}  // namespace lodeline

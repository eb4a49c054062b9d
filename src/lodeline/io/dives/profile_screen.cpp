#include "lodeline/io/dives/profile_screen.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

using Rows = std::vector<ProfileRow>;

/// The longest step in time within a dive, s.
double longestStep(const Rows& rows) {
  constexpr double kUsual_s = 600.0, kLongest_s = 3600.0;
  std::vector<double> steps_s;
  for (size_t i = 1; i < rows.size(); ++i) {
    const double step_s = rows[i].time_s - rows[i - 1].time_s;
    if (step_s > 0.0) steps_s.push_back(step_s);
  }
  return std::clamp(10.0 * median(steps_s), kUsual_s, kLongest_s);
}

/// Test whether one reading can follow another.
class Succession {
 public:
  Succession(const Rows& rows, bool has_stated_dives)
      : longest_s_(has_stated_dives ? std::numeric_limits<double>::max() : longestStep(rows)) {}

  bool operator()(const ProfileRow& before, const ProfileRow& after) const {
    const double step_s = after.time_s - before.time_s;
    return before.dive == after.dive && step_s > 0.0 && step_s <= longest_s_;
  }

 private:
  double longest_s_;
};

/// The rows with a day added after each midnight of a clock that counts to 24
/// h.
Rows pastMidnight(Rows rows) {
  constexpr double kDay_s = 86400.0, kHalfDay_s = 43200.0;
  double added_s = 0.0;
  for (size_t i = 1; i < rows.size(); ++i) {
    const double before_s = rows[i - 1].time_s - added_s;
    const bool is_clock = before_s < kDay_s && before_s > kHalfDay_s && rows[i].time_s >= 0.0;
    if (rows[i].dive != rows[i - 1].dive) added_s = 0.0;
    if (is_clock && rows[i].dive == rows[i - 1].dive && before_s - rows[i].time_s > kDay_s - 3600.0)
      added_s += kDay_s;
    rows[i].time_s += added_s;
  }
  return rows;
}

/// The rows with the earliest first, where the log begins with the latest.
Rows inOrder(Rows rows) {
  size_t forwards = 0, backwards = 0;
  for (size_t i = 1; i < rows.size(); ++i) ++(rows[i].time_s > rows[i - 1].time_s ? forwards : backwards);
  if (backwards > 4 * forwards) std::reverse(rows.begin(), rows.end());
  return rows;
}

/// Sequences without a jump in time. Up to three rows that do not fit are
/// dropped if a later row fits.
std::vector<Rows> stretches(const Rows& rows, const Succession& follows, const PassOverRow& pass_over) {
  constexpr size_t kAhead = 3;
  std::vector<Rows> parts;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (parts.empty()) {
      parts.push_back({rows[i]});
      continue;
    }
    const ProfileRow& last = parts.back().back();
    const auto ahead_end = rows.begin() + static_cast<std::ptrdiff_t>(std::min(i + 1 + kAhead, rows.size()));
    if (follows(last, rows[i])) {
      parts.back().push_back(rows[i]);
    } else if (std::any_of(rows.begin() + static_cast<std::ptrdiff_t>(i) + 1, ahead_end,
                           [&](const ProfileRow& later) { return follows(last, later); })) {
      pass_over(rows[i], "no later time than the row before, or a much later one");
    } else {
      parts.push_back({rows[i]});
    }
  }
  return parts;
}

}  // namespace

std::vector<Rows> splitDives(const Rows& all, bool has_stated_dives, const PassOverRow& pass_over) {
  constexpr size_t kFewestRows = 5, kFewestOfStatedDive = 2;
  const Rows rows = pastMidnight(inOrder(all));
  const Succession follows(rows, has_stated_dives);
  std::vector<Rows> dives;
  for (Rows& part : stretches(rows, follows, pass_over)) {
    if (part.size() < (has_stated_dives ? kFewestOfStatedDive : kFewestRows)) {
      for (const ProfileRow& row : part)
        pass_over(row, "its time fits neither the rows before nor those after");
    } else if (!dives.empty() && follows(dives.back().back(), part.front())) {
      dives.back().insert(dives.back().end(), part.begin(), part.end());
    } else {
      dives.push_back(std::move(part));
    }
  }
  return dives;
}

void screenDepths(Rows* dive, const PassOverRow& pass_over) {
  constexpr double kTooDeep = 6.0, kJump = 2.0, kAboveWater = 0.05, kDeep = 0.25;
  constexpr size_t kFewestToCompare = 10;
  std::vector<double> depths;
  for (const ProfileRow& row : *dive) depths.push_back(row.depth);
  const bool are_heights = median(depths) < 0.0;
  if (are_heights) {
    for (double& depth : depths) depth = -depth;
  }
  const double usual = orderStatistic(depths, 0.75);
  Rows kept;
  for (size_t i = 0; i < depths.size(); ++i) {
    ProfileRow row = (*dive)[i];
    row.depth = depths[i] + 0.0;
    const double before = kept.empty() ? usual : kept.back().depth;
    const double after = i + 1 < depths.size() ? depths[i + 1] : 0.0;
    const bool is_wild = depths.size() >= kFewestToCompare && std::abs(row.depth) > kTooDeep * usual &&
                         std::abs(row.depth - before) > kJump * usual;
    const bool is_gap = row.depth == 0.0 && before > kDeep * usual && after > kDeep * usual && !kept.empty();
    if (usual > 0.0 && (is_wild || is_gap || row.depth < -kAboveWater * usual)) {
      pass_over(row, "a depth that the diver cannot have had there");
    } else {
      kept.push_back(row);
    }
  }
  *dive = std::move(kept);
}

}  // namespace lodeline

#include "lodeline/output/survey/cave/cave_paths.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/cave/point_cells.h"

namespace lodeline {
namespace {

constexpr size_t kNone = static_cast<size_t>(-1);

/// A stretch of points with the same is_new.
struct Stretch {
  size_t first, last;
};

class Splitter {
 public:
  Splitter(const CavePathOptions& options) : options_(options), cells_(std::max(options.merge_m, 0.1)) {}

  CavePaths split(const std::vector<std::vector<Vec3>>& positions) {
    for (size_t dive = 0; dive < positions.size(); ++dive) addDive(dive, positions[dive]);
    if (paths_.branches.empty()) throw InputError("the rig did not move: there is no way to survey");
    return paths_;
  }

 private:
  std::vector<CavePathPoint>& points() { return paths_.points; }

  void addDive(size_t dive, const std::vector<Vec3>& positions) {
    const size_t begin = points().size();
    appendPath(dive, positions);
    if (points().size() - begin < 2) {
      points().resize(begin);
      return;
    }
    label(begin);
    smooth(begin);
    const size_t earlier_branches = paths_.branches.size();
    for (const Stretch& s : stretches(begin)) {
      if (points()[s.first].is_new) addBranch(begin, s);
    }
    if (dive > 0 && earlier_branches > 0) connect(dive, begin, earlier_branches);
  }

  void appendPath(size_t dive, const std::vector<Vec3>& positions) {
    double way_m = 0.0;
    for (size_t i = 0; i < positions.size(); ++i) {
      const bool is_first = points().empty() || points().back().dive != dive;
      const double step_m = is_first ? 0.0 : (positions[i] - points().back().position).norm();
      if (!is_first && step_m < options_.step_m && i + 1 != positions.size()) continue;
      way_m += step_m;
      points().push_back({dive, i, positions[i], way_m, true});
    }
  }

  /// A point near one of an earlier dive, or near one that the dive left long before, is not new.
  void label(size_t begin) {
    if (options_.merge_m <= 0.0) return;
    size_t added = begin;
    for (size_t k = begin; k < points().size(); ++k) {
      CavePathPoint& point = points()[k];
      for (; points()[added].way_m < point.way_m - options_.recent_m(); ++added) {
        if (points()[added].is_new) cells_.add(added, points()[added].position);
      }
      point.is_new = !cells_.hasWithin(point.position, options_.merge_m);
    }
    for (; added < points().size(); ++added) {
      if (points()[added].is_new) cells_.add(added, points()[added].position);
    }
  }

  std::vector<Stretch> stretches(size_t begin) {
    std::vector<Stretch> found;
    for (size_t k = begin; k < points().size(); ++k) {
      if (k == begin || points()[k].is_new != points()[k - 1].is_new) found.push_back({k, k});
      found.back().last = k;
    }
    return found;
  }

  double length_m(const Stretch& s) { return points()[s.last].way_m - points()[s.first].way_m; }

  void setNew(const Stretch& s, bool is_new) {
    for (size_t k = s.first; k <= s.last; ++k) points()[k].is_new = is_new;
  }

  void smooth(size_t begin) {
    std::vector<Stretch> all = stretches(begin);
    for (size_t i = 1; i + 1 < all.size(); ++i) {
      if (!points()[all[i].first].is_new && length_m(all[i]) < options_.touch_m) setNew(all[i], true);
    }
    all = stretches(begin);
    if (all.size() < 2) return;
    for (const Stretch& s : all) {
      if (points()[s.first].is_new && length_m(s) < options_.branch_m) setNew(s, false);
    }
  }

  /// Nearest new point that `may` allows.
  size_t nearest(const Vec3& position, const std::function<bool(size_t)>& may) {
    size_t best = kNone;
    for (size_t k = 0; k < points().size(); ++k) {
      if (!points()[k].is_new || !may(k)) continue;
      if (best == kNone || (points()[k].position - position).squaredNorm() <
                               (points()[best].position - position).squaredNorm())
        best = k;
    }
    return best;
  }

  void addBranch(size_t begin, const Stretch& s) {
    CavePathBranch branch;
    branch.first = s.first;
    branch.last = s.last;
    if (s.first > begin) {
      const size_t at = nearest(points()[s.first].position, [&](size_t k) { return k < s.first; });
      if (at != kNone) branch.begins_at = at;
    }
    if (s.last + 1 < points().size()) endBranch(s, &branch);
    if (branch.last > branch.first || branch.begins_at || branch.ends_at) {
      paths_.branches.push_back(branch);
    } else {
      setNew(s, false);
    }
  }

  /// The path goes on along an earlier one: a turn, or a junction.
  void endBranch(const Stretch& s, CavePathBranch* branch) {
    const double newest_m = points()[s.last].way_m - options_.merge_m;
    const size_t at = nearest(points()[s.last + 1].position, [&](size_t k) {
      return k < s.first || (k <= s.last && points()[k].way_m < newest_m);
    });
    if (at == kNone) return;
    const double back_m = points()[s.last].way_m - points()[at].way_m;
    const bool is_turn = at >= s.first && back_m < 2.0 * options_.recent_m();
    if (!is_turn) {
      branch->ends_at = at;
      return;
    }
    size_t turn = at;
    for (size_t k = at; k <= s.last; ++k) {
      if ((points()[k].position - points()[at].position).norm() >
          (points()[turn].position - points()[at].position).norm())
        turn = k;
    }
    if (turn < s.last) setNew({turn + 1, s.last}, false);
    branch->last = turn;
  }

  /// Adds a line to an earlier dive where a dive meets none.
  void connect(size_t dive, size_t begin, size_t first_branch) {
    bool meets = false, has_branch = paths_.branches.size() > first_branch;
    for (size_t b = first_branch; b < paths_.branches.size(); ++b) {
      for (const std::optional<size_t>& at : {paths_.branches[b].begins_at, paths_.branches[b].ends_at})
        meets = meets || (at && *at < begin);
    }
    if (meets || !has_branch) return;
    paths_.apart.push_back(dive);
    CavePathBranch line;
    line.is_connection = true;
    double best_m = HUGE_VAL;
    for (size_t k = begin; k < points().size(); ++k) {
      if (!points()[k].is_new) continue;
      const size_t at = nearest(points()[k].position, [&](size_t other) { return other < begin; });
      const double distance_m = (points()[k].position - points()[at].position).norm();
      if (distance_m >= best_m) continue;
      best_m = distance_m;
      line.first = line.last = k;
      line.ends_at = at;
    }
    paths_.branches.push_back(line);
  }

  CavePathOptions options_;
  PointCells cells_;
  CavePaths paths_;
};

}  // namespace

CavePaths splitPaths(const std::vector<std::vector<Vec3>>& positions, const CavePathOptions& options) {
  return Splitter(options).split(positions);
}

}  // namespace lodeline

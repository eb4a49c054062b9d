#include "lodeline/output/survey/map/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

/// Indices of positions at least `resolution_m` from the one before, and of the last.
std::vector<size_t> thinned(const std::vector<Vec3>& positions, double resolution_m) {
  std::vector<size_t> kept = {0};
  for (size_t i = 1; i < positions.size(); ++i) {
    if ((positions[i] - positions[kept.back()]).norm() >= resolution_m) kept.push_back(i);
  }
  if (kept.back() != positions.size() - 1) kept.push_back(positions.size() - 1);
  return kept;
}

double angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// A path as a sequence of points at some distance from each other.
class Way {
 public:
  Way(const std::vector<Vec3>& positions, const std::vector<size_t>& indices) {
    for (size_t index : indices) points_.push_back(positions[index]);
  }

  size_t size() const { return points_.size(); }
  double distance(size_t from, size_t to) const { return (points_[to] - points_[from]).norm(); }

  /// Angle between the line station -> at and the path of the next `ahead_m`; zero at the end of the path.
  double bendAt(size_t station, size_t at, double ahead_m) const {
    size_t next = at;
    while (next + 1 < points_.size() && distance(at, next) < ahead_m) ++next;
    if (distance(at, next) < 0.5 * ahead_m) return 0.0;
    return angleBetween(points_[at] - points_[station], points_[next] - points_[at]);
  }

 private:
  std::vector<Vec3> points_;
};

/// Index of the point that becomes the station after `station`, at most the last point.
size_t nextStation(const Way& way, size_t station, const StationOptions& options) {
  // Where the path comes back, its farthest point is the station, and not the point with the largest bend.
  constexpr double kTurnsBack_rad = 2.6;
  const double ahead_m = 0.5 * options.bend_spacing_m;
  double farthest_m = 0.0;
  size_t farthest = station;
  for (size_t at = station + 1; at + 1 < way.size(); ++at) {
    const double distance_m = way.distance(station, at);
    if (distance_m >= options.spacing_m) return at;
    if (distance_m > farthest_m) {
      farthest_m = distance_m;
      farthest = at;
    }
    if (farthest_m >= ahead_m && distance_m < farthest_m - ahead_m) return farthest;
    if (distance_m < options.bend_spacing_m) continue;
    const double bend = way.bendAt(station, at, ahead_m);
    if (bend >= options.bend_rad && bend < kTurnsBack_rad && way.bendAt(station, at + 1, ahead_m) <= bend)
      return at;
  }
  return way.size() - 1;
}

}  // namespace

std::vector<size_t> chooseStations(const std::vector<Vec3>& positions, const StationOptions& options) {
  if (positions.size() < 2) throw InputError("a survey takes at least two poses");
  const std::vector<size_t> kept = thinned(positions, options.path_resolution_m);
  const Way way(positions, kept);
  std::vector<size_t> stations = {0};
  while (stations.back() + 1 < way.size()) stations.push_back(nextStation(way, stations.back(), options));
  // A very short last leg is joined to the one before.
  if (stations.size() > 2 && way.distance(stations[stations.size() - 2], stations.back()) < 1.0) {
    stations.erase(stations.end() - 2);
  }
  if (way.distance(stations.front(), stations.back()) < 1e-3 && stations.size() < 3) {
    throw InputError("the rig did not move: there is no way to survey");
  }
  for (size_t& station : stations) station = kept[station];
  return stations;
}

double Survey::length_m() const {
  double length = 0.0;
  for (size_t i = 1; i < stations.size(); ++i) {
    length += (stations[i].position_ENU - stations[i - 1].position_ENU).norm();
  }
  return length;
}

namespace {

/// Vector from a point to the nearest point of a polyline.
Vec3 offsetTo(const std::vector<SurveyStation>& stations, size_t last, const Vec3& point) {
  Vec3 nearest = stations.front().position_ENU - point;
  for (size_t i = 1; i <= last; ++i) {
    const Vec3 begin = stations[i - 1].position_ENU;
    const Vec3 leg = stations[i].position_ENU - begin;
    const double share = std::clamp((point - begin).dot(leg) / std::max(leg.squaredNorm(), 1e-12), 0.0, 1.0);
    const Vec3 offset = begin + share * leg - point;
    if (offset.squaredNorm() < nearest.squaredNorm()) nearest = offset;
  }
  return nearest;
}

}  // namespace

Misclosure misclosure(const Survey& survey) {
  const std::vector<SurveyStation>& stations = survey.stations;
  const auto fromStart = [&](size_t i) -> Vec3 {
    return stations[i].position_ENU - stations[0].position_ENU;
  };
  Misclosure result;
  result.length_m = survey.length_m();
  result.end_from_start_ENU = fromStart(stations.size() - 1);
  size_t turn = 0;
  for (size_t i = 1; i < stations.size(); ++i) {
    if (fromStart(i).norm() > fromStart(turn).norm()) turn = i;
  }
  if (result.end_from_start_ENU.norm() > 0.5 * fromStart(turn).norm()) return result;
  std::vector<double> horizontal, vertical;
  for (size_t i = turn + 1; i < stations.size(); ++i) {
    const Vec3 offset = offsetTo(stations, turn, stations[i].position_ENU);
    horizontal.push_back(offset.head<2>().norm());
    vertical.push_back(std::abs(offset.z()));
  }
  result.horizontal_between_ways_m = computeStatistics(horizontal).median;
  result.vertical_between_ways_m = computeStatistics(vertical).median;
  return result;
}

Vec3 legSigma(const Vec3& end_sigma, size_t legs) {
  return (end_sigma / std::sqrt(static_cast<double>(std::max<size_t>(legs, 1)))).cwiseMax(1e-3);
}

}  // namespace lodeline

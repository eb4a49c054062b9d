#include "simulation/rendering/cave/passage_curve.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace lodeline {
namespace {

// Steps per station in the table of lengths. With bends of 4 m and stations 0.25 m apart, the chords of the
// steps are shorter than the arcs by 1e-7 of the length.
constexpr int kStepsPerStation = 60;

Vec3 tangentAt(const PassageCurve& curve, double u, double step, double begin, double end, bool closed) {
  const double low = closed ? u - step : std::max(begin, u - step);
  const double high = closed ? u + step : std::min(end, u + step);
  return (curve(high).position_W - curve(low).position_W).normalized();
}

}  // namespace

Centerline evenlySpaced(const PassageCurve& curve, double begin, double end, double first_arc_length_m,
                        bool closed, double spacing_m) {
  // A coarse table gives the length, and with it the number of steps of the fine one.
  const auto table = [&](int steps) {
    std::vector<double> lengths_m(1, 0.0);
    Vec3 before = curve(begin).position_W;
    for (int i = 1; i <= steps; ++i) {
      const Vec3 here = curve(begin + (end - begin) * i / steps).position_W;
      lengths_m.push_back(lengths_m.back() + (here - before).norm());
      before = here;
    }
    return lengths_m;
  };
  const int pieces = std::max(3, static_cast<int>(std::lround(table(2000).back() / spacing_m)));
  const int steps = kStepsPerStation * pieces;
  const std::vector<double> lengths_m = table(steps);
  std::vector<PassageStation> stations;
  for (int k = 0; k < (closed ? pieces : pieces + 1); ++k) {
    const double wanted_m = lengths_m.back() * k / pieces;
    const auto above = std::upper_bound(lengths_m.begin() + 1, lengths_m.end() - 1, wanted_m);
    const double share = (wanted_m - *(above - 1)) / (*above - *(above - 1));
    const double step = (end - begin) / steps;
    const double u = begin + step * (static_cast<double>(above - 1 - lengths_m.begin()) + share);
    const PassagePoint point = curve(u);
    stations.push_back({first_arc_length_m + wanted_m, point.position_W,
                        tangentAt(curve, u, 0.2 * step, begin, end, closed), point.width_m, point.height_m});
  }
  return Centerline::through(std::move(stations), closed);
}

double smoothRise(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

}  // namespace lodeline

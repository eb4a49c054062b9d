#include "simulation/rendering/cave/centerline.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

void check(const CenterlineOptions& o) {
  const auto positive = [](double value, const char* name) {
    if (!(std::isfinite(value) && value > 0.0)) {
      throw UsageError(fmt::format("passage option {} must be positive, got {}", name, value));
    }
  };
  positive(o.length_m, "length_m");
  positive(o.station_spacing_m, "station_spacing_m");
  positive(o.shortest_bend_m, "shortest_bend_m");
  positive(o.mean_width_m, "mean_width_m");
  positive(o.mean_height_m, "mean_height_m");
  if (!(o.lead_in_m >= 0.0 && o.run_out_m >= 0.0)) {
    throw UsageError("passage options lead_in_m and run_out_m must not be negative");
  }
}

// Section size relative to the mean, limited to a third to two and a half times.
double section(double mean, double variation, double wave) {
  return mean * std::clamp(std::exp(variation * wave), 0.35, 2.5);
}

}  // namespace

Centerline Centerline::generate(const CenterlineOptions& o) {
  check(o);
  const Waves winding(o.seed, "centerline/winding", o.shortest_bend_m, 6.0 * o.shortest_bend_m);
  const Waves undulation(o.seed, "centerline/undulation", 12.0, 70.0);
  const Waves width(o.seed, "centerline/width", 5.0, 50.0);
  const Waves height(o.seed, "centerline/height", 6.0, 40.0);
  constexpr double kMaxBend = 75.0 * std::numbers::pi / 180.0;
  const auto tangentAt = [&](double s) {
    const double bend = kMaxBend * std::tanh(o.bend_rad / kMaxBend * winding(s));
    const double azimuth = o.main_azimuth_rad + bend;
    // Slope of a cosine-shaped descent plus that of the undulation.
    const double along = std::clamp(s / o.length_m, 0.0, 1.0);
    const double descent =
        0.5 * std::numbers::pi * std::sin(std::numbers::pi * along) * o.descent_m / o.length_m;
    const double rise = o.undulation_m * undulation.derivative(s);
    const double slope = std::clamp(rise - descent, -0.6, 0.6);
    return Vec3(std::sin(azimuth), std::cos(azimuth), slope).normalized();
  };

  Centerline line;
  line.spacing_m_ = o.station_spacing_m;
  const int before = static_cast<int>(std::ceil(o.lead_in_m / o.station_spacing_m));
  const int after = static_cast<int>(std::ceil((o.length_m + o.run_out_m) / o.station_spacing_m));
  Vec3 position = Vec3::Zero();
  for (int i = -before; i <= after; ++i) {
    const double s = i * o.station_spacing_m;
    if (i > -before) {
      const double half = 0.5 * o.station_spacing_m;
      // Simpson's rule over the step.
      position +=
          o.station_spacing_m / 6.0 * (tangentAt(s - 2.0 * half) + 4.0 * tangentAt(s - half) + tangentAt(s));
    }
    line.stations_.push_back({s, position, tangentAt(s),
                              section(o.mean_width_m, o.section_variation, width(s)),
                              section(o.mean_height_m, o.section_variation, height(s))});
  }
  return line.translated(-line.stations_[before].position_W);
}

Centerline Centerline::through(std::vector<PassageStation> stations, bool closed) {
  if (stations.size() < 2) throw UsageError("a passage needs two or more stations");
  Centerline line;
  line.spacing_m_ = (stations.back().arc_length_m - stations.front().arc_length_m) /
                    static_cast<double>(stations.size() - 1);
  line.closed_ = closed;
  line.stations_ = std::move(stations);
  return line;
}

PassageStation Centerline::at(double arc_length_m) const {
  const double inside =
      closed_ ? arc_length_m - length_m() * std::floor((arc_length_m - beginArcLength()) / length_m())
              : std::clamp(arc_length_m, beginArcLength(), endArcLength());
  const double index = (inside - beginArcLength()) / spacing_m_;
  const size_t i = std::min(static_cast<size_t>(index), stations_.size() - (closed_ ? 1 : 2));
  const double u = index - static_cast<double>(i);
  const PassageStation& a = stations_[i];
  const PassageStation& b = stations_[(i + 1) % stations_.size()];
  const double u2 = u * u, u3 = u2 * u;
  PassageStation station;
  station.arc_length_m = arc_length_m;
  station.position_W = (2 * u3 - 3 * u2 + 1) * a.position_W + (u3 - 2 * u2 + u) * spacing_m_ * a.tangent_W +
                       (3 * u2 - 2 * u3) * b.position_W + (u3 - u2) * spacing_m_ * b.tangent_W;
  station.tangent_W = ((1 - u) * a.tangent_W + u * b.tangent_W).normalized();
  if (!closed_) station.position_W += (arc_length_m - inside) * station.tangent_W;
  station.width_m = (1 - u) * a.width_m + u * b.width_m;
  station.height_m = (1 - u) * a.height_m + u * b.height_m;
  return station;
}

double Centerline::nearestArcLength(const Vec3& point_W, double near_arc_length_m, double window_m) const {
  double best_s = near_arc_length_m;
  double best_distance = (at(near_arc_length_m).position_W - point_W).squaredNorm();
  for (const PassageStation& station : stations_) {
    if (std::abs(station.arc_length_m - near_arc_length_m) > window_m) continue;
    const double distance = (station.position_W - point_W).squaredNorm();
    if (distance < best_distance) {
      best_distance = distance;
      best_s = station.arc_length_m;
    }
  }
  return best_s;
}

Centerline Centerline::translated(const Vec3& offset_W) const {
  Centerline moved = *this;
  for (PassageStation& station : moved.stations_) station.position_W += offset_W;
  return moved;
}

Centerline Centerline::reversed(double zero_arc_length_m) const {
  Centerline turned = *this;
  std::reverse(turned.stations_.begin(), turned.stations_.end());
  for (PassageStation& station : turned.stations_) {
    station.arc_length_m = zero_arc_length_m - station.arc_length_m;
    station.tangent_W = -station.tangent_W;
  }
  return turned;
}

}  // namespace lodeline

#include "lodeline/io/video/gpmf/sample_clock.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/util/median.h"

namespace lodeline::gpmf {
namespace {

constexpr size_t kPayloadsEachSide = 60;  // of about one second
/// A count that leaps by more is damaged: no camera loses so much and goes on.
constexpr double kGreatestLoss = 100'000.0;
constexpr double kHuber = 1.345;
constexpr int kRounds = 8;

/// A line from medians: slopes between points half of the record apart.
ClockLine roughLine(const std::vector<ClockPoint>& points) {
  std::vector<double> slopes, offsets;
  const size_t half = std::max<size_t>(1, points.size() / 2);
  for (size_t i = 0; i + half < points.size(); ++i) {
    const double step = points[i + half].x - points[i].x;
    if (step > 0.0) slopes.push_back((points[i + half].y - points[i].y) / step);
  }
  ClockLine line;
  line.centre = points[points.size() / 2].x;
  if (slopes.empty()) return line;
  line.slope = median(slopes);
  for (const ClockPoint& point : points) offsets.push_back(point.y - line.slope * (point.x - line.centre));
  line.at_centre = median(offsets);
  return line;
}

std::vector<double> distances(const std::vector<ClockPoint>& points, const ClockLine& line) {
  std::vector<double> result;
  for (const ClockPoint& point : points) result.push_back(std::abs(point.y - line.at(point.x)));
  return result;
}

}  // namespace

std::optional<ClockLine> fitLine(const std::vector<ClockPoint>& points) {
  if (points.size() < 2) return std::nullopt;
  ClockLine line = roughLine(points);
  if (!(line.slope > 0.0)) return std::nullopt;
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<double> off = distances(points, line);
    const double sigma = std::max(1.4826 * median(off), 1e-9);
    double weight = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (size_t i = 0; i < points.size(); ++i) {
      const double w = off[i] <= kHuber * sigma ? 1.0 : kHuber * sigma / off[i];
      const double dx = points[i].x - line.centre, dy = points[i].y - line.at_centre;
      weight += w;
      x += w * dx;
      y += w * dy;
      xx += w * dx * dx;
      xy += w * dx * dy;
    }
    const double spread = xx - x * x / weight;
    if (!(spread > 0.0)) return line;
    const double slope = (xy - x * y / weight) / spread;
    if (!(slope > 0.0)) return line;
    line = {line.centre + x / weight, line.at_centre + y / weight, slope};
  }
  return line;
}

SampleClock::SampleClock(const std::vector<PayloadSamples>& payloads,
                         const std::optional<ClockLine>& clock_map) {
  number(payloads);
  std::vector<ClockPoint> starts, stamps, map;
  for (size_t i = 0; i < payloads.size(); ++i) {
    starts.push_back({first_sample_[i], payloads[i].time_s});
    if (!payloads[i].stamp_s || (!map.empty() && *payloads[i].stamp_s <= map.back().x)) continue;
    stamps.push_back({first_sample_[i], *payloads[i].stamp_s});
    map.push_back({*payloads[i].stamp_s, payloads[i].time_s});
  }
  if (payloads.empty()) return;
  const PayloadSamples& last = payloads.back();
  if (last.length_s > 0.0) {
    starts.push_back({first_sample_.back() + static_cast<double>(last.samples), last.time_s + last.length_s});
  }
  const std::optional<ClockLine> to_images = clock_map ? clock_map : fitLine(map);
  const bool has_stamps = stamps.size() == payloads.size() && stamps.size() >= 2 && to_images;
  if (has_stamps) {
    for (ClockPoint& point : stamps) point.y = to_images->at(point.y);
  }
  fit(has_stamps ? stamps : starts);
}

void SampleClock::number(const std::vector<PayloadSamples>& payloads) {
  double next = 0.0;
  std::optional<double> base;  // what the camera had counted before the first sample
  for (const PayloadSamples& payload : payloads) {
    const auto count = static_cast<double>(payload.samples);
    double first = next;
    if (payload.total_samples) {
      const double counted = static_cast<double>(*payload.total_samples) - count;
      if (!base || (payload.starts_file && counted < *base + next)) base = counted - next;
      const double lost = counted - *base - next;
      if (lost < 0.0 || lost > kGreatestLoss) {
        problems_.push_back(
            fmt::format("at {:.3f} s the count of samples (TSMP) leaps by {:.0f}; the samples "
                        "are taken as following each other",
                        payload.time_s, lost));
        base = counted - next;
      } else if (lost > 0.0) {
        problems_.push_back(
            fmt::format("before {:.3f} s the camera lost {:.0f} samples", payload.time_s, lost));
        first = next + lost;
      }
    }
    first_sample_.push_back(first);
    next = first + count;
    received_ += payload.samples;
  }
  samples_ = next;
}

void SampleClock::fit(const std::vector<ClockPoint>& points) {
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t begin = i < kPayloadsEachSide ? 0 : i - kPayloadsEachSide;
    const size_t end = std::min(points.size(), i + kPayloadsEachSide + 1);
    const std::optional<ClockLine> line = fitLine({points.begin() + static_cast<std::ptrdiff_t>(begin),
                                                   points.begin() + static_cast<std::ptrdiff_t>(end)});
    if (!line) continue;
    const double time_s = line->at(points[i].x);
    if (knots_.empty() || (points[i].x > knots_.back().x && time_s > knots_.back().y)) {
      knots_.push_back({points[i].x, time_s});
    }
  }
  if (knots_.size() < 2) return;
  rate_hz_ = (knots_.back().x - knots_.front().x) / (knots_.back().y - knots_.front().y);
  std::vector<double> off;
  for (const ClockPoint& point : points) off.push_back(std::abs(point.y - time_s(point.x)));
  jitter_s_ = median(off);
}

double SampleClock::time_s(double sample) const {
  if (knots_.size() < 2) return 0.0;
  const auto isBefore = [](const ClockPoint& knot, double x) { return knot.x < x; };
  auto after = std::lower_bound(knots_.begin() + 1, knots_.end() - 1, sample, isBefore);
  const ClockPoint& from = *(after - 1);
  return from.y + (sample - from.x) * (after->y - from.y) / (after->x - from.x);
}

}  // namespace lodeline::gpmf

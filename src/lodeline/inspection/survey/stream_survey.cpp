#include "lodeline/inspection/survey/stream_survey.h"

#include <algorithm>
#include <cmath>

#include "lodeline/io/streams/stamp_bursts.h"
#include "lodeline/io/streams/stream_rate.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// A sensor that repeats its reading for longer than this does not measure.
constexpr double kFrozen_s = 1.0;

/// Usual interval between bursts.
double stepBetweenBursts_s(const std::vector<double>& steps_s, double period_s) {
  std::vector<double> between_s;
  for (const double step_s : steps_s) {
    if (step_s > 1.5 * period_s) between_s.push_back(step_s);
  }
  return between_s.empty() ? 0.0 : median(between_s);
}

}  // namespace

std::vector<Time> StreamSurvey::firstStamps() const {
  const size_t count = std::min(stamps_.size(), kStampsForRate);
  return {stamps_.begin(), stamps_.begin() + static_cast<std::ptrdiff_t>(count)};
}

void StreamSurvey::add(Time time, bool repeats) {
  if (!stamps_.empty()) {
    if (time == previous_) ++counts_.duplicates;
    if (time < previous_) ++counts_.backwards;
    if (repeats) {
      ++counts_.repeated;
      if (!frozen_since_) frozen_since_ = previous_;
    }
  }
  if (!repeats) closeFrozen();
  stamps_.push_back(time);
  previous_ = time;
}

void StreamSurvey::closeFrozen() {
  if (!frozen_since_) return;
  const double length_s = (previous_ - *frozen_since_).seconds();
  counts_.longest_frozen_s = std::max(counts_.longest_frozen_s, length_s);
  if (length_s >= kFrozen_s) frozen_s_ += length_s;
  frozen_since_.reset();
}

StreamSummary StreamSurvey::summarize(double gap_periods) const {
  StreamSurvey closed = *this;
  closed.closeFrozen();
  StreamSummary summary = closed.counts_;
  std::vector<Time>& stamps = closed.stamps_;
  summary.readings = static_cast<int64_t>(stamps.size());
  if (stamps.empty()) return summary;
  std::sort(stamps.begin(), stamps.end());
  summary.first = stamps.front();
  summary.last = stamps.back();
  summary.duration_s = (stamps.back() - stamps.front()).seconds();
  if (summary.duration_s > 0.0) summary.frozen_share = closed.frozen_s_ / summary.duration_s;
  std::vector<double> steps_s;
  for (size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) steps_s.push_back((stamps[i] - stamps[i - 1]).seconds());
  }
  if (steps_s.size() < 2) return summary;
  const std::optional<Duration> burst_period = burstPeriod(closed.firstStamps());
  const double step_s = burst_period ? burst_period->seconds() : median(steps_s);
  summary.rate_hz = 1.0 / step_s;
  std::vector<double> deviations_s;
  for (const double s : steps_s) deviations_s.push_back(std::abs(s - step_s));
  summary.jitter_s = median(deviations_s);
  double longest_step_s = gap_periods * step_s;
  if (burst_period) longest_step_s = std::max(longest_step_s, 2.0 * stepBetweenBursts_s(steps_s, step_s));
  for (size_t i = 1; i < stamps.size(); ++i) {
    const double length_s = (stamps[i] - stamps[i - 1]).seconds();
    if (length_s <= longest_step_s) continue;
    summary.gaps.push_back({stamps[i - 1], length_s});
    summary.gap_s += length_s;
  }
  std::sort(summary.gaps.begin(), summary.gaps.end(),
            [](const StreamGap& a, const StreamGap& b) { return a.length_s > b.length_s; });
  return summary;
}

}  // namespace lodeline

#include "simulation/motion/swim_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "simulation/shared/random.h"
#include "simulation/shared/smoother_step.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kStep_s = 0.05;
// Margin of the samples beyond both ends of the dive, for the outer control points of the splines.
constexpr double kBorder_s = 10.0;
constexpr double kEndRest_s = 1.5;
// Time until all smoothed functions (speed, activity, the splines of the path) are at rest.
constexpr double kSettle_s = 2.75;

// Moving average over +-`half_width_s`, applied twice, which gives a continuous rate of change.
std::vector<double> smoothed(std::vector<double> values, double half_width_s) {
  const int half = static_cast<int>(std::lround(half_width_s / kStep_s));
  const int count = static_cast<int>(values.size());
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> sums(count + 1, 0.0);
    for (int i = 0; i < count; ++i) sums[i + 1] = sums[i] + values[i];
    for (int i = 0; i < count; ++i) {
      const int begin = std::max(0, i - half);
      const int end = std::min(count, i + half + 1);
      values[i] = (sums[end] - sums[begin]) / (end - begin);
    }
  }
  return values;
}

}  // namespace

SwimPlan::SwimPlan(const SwimPlanOptions& options) : options_(options) {
  const SwimPlanOptions& o = options_;
  const double rest_s = o.starts_at_rest ? o.start_rest_s + kSettle_s : 0.0;
  scheduleTurns(rest_s);
  const std::vector<Pause> all = pauses();
  const Waves variation(o.seed, "swim/speed", 8.0, 60.0);

  const int count = static_cast<int>(std::ceil((o.duration_s + 2.0 * kBorder_s) / kStep_s)) + 1;
  for (int i = 0; i < count; ++i) {
    const double t = i * kStep_s - kBorder_s;
    double speed = std::clamp(1.0 + 0.2 * variation(t), 0.6, 1.4);
    double activity = 1.0;
    for (const Pause& pause : all) {
      if (t < pause.begin_s || t > pause.end_s) continue;
      speed = 0.0;
      if (pause.still) activity = 0.0;
    }
    kick_.push_back(speed);
    activity_.push_back(activity);
    double turns = 0.0;
    if (legs_m_.size() > 1) {
      for (const double begin_s : turn_begin_s_) turns += smootherStep01((t - begin_s) / o.turn_s);
    }
    turn_.push_back(turns);
  }
  kick_ = smoothed(kick_, 0.6);
  activity_ = smoothed(activity_, 0.5);
  integrateSpeed();
}

// Every leg gets the share of the swimming time that it has of the path.
void SwimPlan::scheduleTurns(double rest_s) {
  const SwimPlanOptions& o = options_;
  legs_m_ = o.legs_m;
  if (legs_m_.empty()) {
    legs_m_ = {o.penetration_m};
    if (o.round_trip) legs_m_.push_back(-o.penetration_m);
  }
  double path_m = 0.0;
  for (const double leg_m : legs_m_) path_m += std::abs(leg_m);
  const auto turns = static_cast<double>(legs_m_.size() - 1);
  double behind_m = 0.0;
  for (size_t k = 0; k + 1 < legs_m_.size(); ++k) {
    behind_m += std::abs(legs_m_[k]);
    turn_begin_s_.push_back(rest_s +
                            behind_m / path_m * (o.duration_s - rest_s - kEndRest_s - turns * o.turn_s) +
                            static_cast<double>(k) * o.turn_s);
  }
  if (turn_begin_s_.empty()) turn_begin_s_.push_back(o.duration_s + kBorder_s);
}

int SwimPlan::leg(double time_s) const {
  int leg = 0;
  for (const double begin_s : turn_begin_s_) {
    if (time_s >= begin_s + 0.5 * options_.turn_s) ++leg;
  }
  return std::min(leg, static_cast<int>(legs_m_.size()) - 1);
}

std::vector<SwimPlan::Pause> SwimPlan::pauses() const {
  const SwimPlanOptions& o = options_;
  std::vector<Pause> all;
  if (o.starts_at_rest) all.push_back({-kBorder_s, o.start_rest_s + kSettle_s, true});
  if (legs_m_.size() > 1) {
    for (const double begin_s : turn_begin_s_) all.push_back({begin_s, begin_s + o.turn_s, false});
  }
  all.push_back({o.duration_s - kEndRest_s, o.duration_s + kBorder_s, false});
  for (const StillPhase& p : o.still_phases) {
    all.push_back({p.begin_s - kSettle_s, p.begin_s + p.duration_s + kSettle_s, true});
  }
  addHalts(all);
  return all;
}

void SwimPlan::addHalts(std::vector<Pause>& pauses) const {
  if (options_.stops_per_minute <= 0.0) return;
  const std::vector<Pause> fixed = pauses;
  Random random(options_.seed, "swim/halts");
  double t = 0.0;
  while (true) {
    t += 60.0 / options_.stops_per_minute * random.uniform(0.5, 1.5);
    const double length_s = random.uniform(4.0, 10.0);
    if (t + length_s > options_.duration_s) return;
    const bool free = std::none_of(fixed.begin(), fixed.end(), [&](const Pause& p) {
      return t < p.end_s + 6.0 && t + length_s > p.begin_s - 6.0;
    });
    if (free) pauses.push_back({t, t + length_s, false});
    t += length_s;
  }
}

void SwimPlan::integrateSpeed() {
  const SwimPlanOptions& o = options_;
  const auto timeOf = [](size_t i) { return static_cast<double>(i) * kStep_s - kBorder_s; };
  std::vector<double> kicks_s(legs_m_.size(), 0.0);  // kick strength integrated over each leg
  double swimming_s = 0.0, path_m = 0.0;
  for (size_t i = 0; i < kick_.size(); ++i) {
    if (timeOf(i) < 0.0 || timeOf(i) > o.duration_s) continue;
    kicks_s[static_cast<size_t>(leg(timeOf(i)))] += kick_[i] * kStep_s;
    if (kick_[i] > 0.3) swimming_s += kStep_s;
  }
  for (const double leg_m : legs_m_) path_m += std::abs(leg_m);
  if (swimming_s == 0.0) {
    throw UsageError(
        fmt::format("{:.0f} s leave no time to swim beside standing still and turning; "
                    "make the dive longer",
                    o.duration_s));
  }
  mean_speed_ = path_m / swimming_s;
  if (!(mean_speed_ >= 0.05 && mean_speed_ <= 0.6)) {
    throw UsageError(
        fmt::format("{:.1f} m in {:.0f} s asks for swimming at {:.2f} m/s; a diver swims at 0.05 to 0.6 m/s, "
                    "so change the length or the duration",
                    path_m, o.duration_s, mean_speed_));
  }
  const size_t zero = static_cast<size_t>(std::lround(kBorder_s / kStep_s));
  std::vector<double> signed_speed(kick_.size());
  for (size_t i = 0; i < kick_.size(); ++i) {
    const auto k = static_cast<size_t>(leg(timeOf(i)));
    signed_speed[i] = kick_[i] * legs_m_[k] / kicks_s[k];
  }
  arc_length_m_.assign(kick_.size(), 0.0);
  for (size_t i = zero; i + 1 < kick_.size(); ++i)
    arc_length_m_[i + 1] = arc_length_m_[i] + signed_speed[i] * kStep_s;
  for (size_t i = zero; i > 0; --i) arc_length_m_[i - 1] = arc_length_m_[i] - signed_speed[i - 1] * kStep_s;
  for (double& kick : kick_) kick = std::min(kick, 1.0);
}

double SwimPlan::sampled(const std::vector<double>& values, double time_s) const {
  const double index =
      std::clamp((time_s + kBorder_s) / kStep_s, 0.0, static_cast<double>(values.size() - 1));
  const size_t i = std::min(static_cast<size_t>(index), values.size() - 2);
  const double u = index - static_cast<double>(i);
  return (1.0 - u) * values[i] + u * values[i + 1];
}

}  // namespace lodeline

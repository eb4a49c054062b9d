#include "lodeline/io/streams/inertial_screen.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "lodeline/io/streams/inertial_limits.h"
#include "lodeline/io/streams/spike_detector.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr const char* kImpossible = "imu_impossible";
constexpr const char* kZero = "imu_zero";
constexpr const char* kSpike = "imu_spike";
constexpr const char* kHeld = "imu_held";
constexpr const char* kStuck = "imu_stuck";
constexpr const char* kSaturated = "imu_saturated";

/// Longer stretches of missing readings count as gaps.
constexpr double kGap_s = 0.1;

std::string valuesOf(const ImuSample& sample) {
  const Vec3& w = sample.angular_velocity_B;
  const Vec3& f = sample.specific_force_B;
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) rad/s, ({:.4g}, {:.4g}, {:.4g}) m/s^2", w.x(), w.y(), w.z(),
                     f.x(), f.y(), f.z());
}

/// Description of the reason for rejecting a reading.
std::string reasonOf(const std::string& kind) {
  if (kind == kImpossible) return "beyond what any inertial sensor can measure";
  if (kind == kZero) return "zero in every axis, where gravity alone gives 9.8 m/s^2";
  if (kind == kSpike) return "a spike against the readings before and after";
  if (kind == kHeld) return "figure by figure the one before: a driver that repeats or a sensor that hangs";
  if (kind == kStuck) return "of a gyroscope or accelerometer that hangs while the other one moves";
  return "at the end of the sensor's range, and the motion beyond it";
}

}  // namespace

const ImuSample* InertialScreen::peek() {
  if (!is_unit_settled_) settleUnit();
  while (!head_ && fetch(1)) {
    ++readings_;
    const std::string kind = objection();
    if (kind != stretch_.kind) closeStretch(kind);
    if (!kind.empty()) {
      leaveOut(kind, pending_.front());
    } else {
      head_ = pending_.front();
      history_.add(*head_);
    }
    pending_.pop_front();
  }
  if (!head_) closeStretch({});
  return head_ ? &*head_ : nullptr;
}

ImuSample InertialScreen::pop() {
  const ImuSample sample = *head_;
  head_.reset();
  return sample;
}

bool InertialScreen::fetch(size_t readings) {
  while (pending_.size() < readings && !has_ended_) {
    const std::optional<ImuSample> sample = pull_();
    has_ended_ = !sample;
    if (sample) pending_.push_back(factors_.apply(*sample));
  }
  return pending_.size() >= readings;
}

void InertialScreen::settleUnit() {
  constexpr size_t kReadings = 50;
  constexpr double kLeast_m_per_s2 = 4.0, kGreatest_m_per_s2 = 50.0;
  is_unit_settled_ = true;
  factors_.rate = Vec3::Constant(options_.rate_to_SI);
  if (!fetch(1)) return;
  const double size = pending_.front().specific_force_B.norm();
  if (size > kLeast_m_per_s2 && size < kGreatest_m_per_s2) return;
  fetch(kReadings);
  const double unit = forceToSI(std::vector<ImuSample>(pending_.begin(), pending_.end()));
  if (unit == 1.0) return;
  diagnostics_->report(
      Severity::Serious, "accelerometer_unit",
      fmt::format(
          "the accelerometer is in {}, not m/s^2: its first reading has a size of {:.4g}; all readings are "
          "multiplied by {:.6g}. Convert the recording",
          unit > 1.0 ? "g" : "mg", size, unit));
  ReadingFactors factors;
  factors.force = Vec3::Constant(unit);
  convertPending(factors);
}

void InertialScreen::convertPending(const ReadingFactors& factors) {
  for (ImuSample& sample : pending_) sample = factors.apply(sample);
  factors_.rate = factors_.rate.cwiseProduct(factors.rate);
  factors_.force = factors_.force.cwiseProduct(factors.force);
}

bool InertialScreen::isPossible(const ImuSample& sample) const {
  return inertial_limits::isPossible(sample, options_.knows_rate_unit ? 1.0 : kDegree);
}

std::string InertialScreen::objection() {
  if (spikes_ahead_ > 0) {
    --spikes_ahead_;
    return kSpike;
  }
  if (inertial_limits::isZero(pending_.front())) return kZero;
  const std::string jump = jumpObjection();
  if (!jump.empty()) return jump;
  if (!isPossible(pending_.front())) return kImpossible;
  return repetition(pending_.front());
}

std::string InertialScreen::jumpObjection() {
  const ImuSample& sample = pending_.front();
  if (!sample.angular_velocity_B.allFinite() || !sample.specific_force_B.allFinite()) return kImpossible;
  if (!isJump(history_, sample)) return {};
  fetch(kUnitReadings);
  std::vector<ImuSample> following;
  for (const ImuSample& next : pending_) {
    if (next.angular_velocity_B.allFinite() && next.specific_force_B.allFinite()) following.push_back(next);
  }
  const std::span<const ImuSample> all(following);
  const size_t spikes = spikesAtFront(history_, all.first(std::min(all.size(), kSpikeReadings)));
  if (spikes > 0) {
    spikes_ahead_ = spikes - 1;
    return isPossible(sample) ? kSpike : kImpossible;
  }
  const std::optional<ReadingFactors> change = changeOfUnit(history_, all);
  if (!change) return {};
  diagnostics_->report(
      Severity::Serious, "imu_changes",
      fmt::format(
          "at stamp {} ns {}: from there on the readings fit those before only when converted, which is "
          "done. Look for what restarted or was configured anew",
          sample.time.nanoseconds(), change->words));
  convertPending(*change);
  return {};
}

std::string InertialScreen::repetition(const ImuSample& sample) {
  const RepeatDetector::Verdict verdict = repeats_.judge(sample);
  const bool is_saturated = verdict == RepeatDetector::Verdict::Fresh && saturation_.isSaturated(sample);
  if (!options_.drops_repeats) return {};
  if (verdict == RepeatDetector::Verdict::Held) return kHeld;
  if (verdict == RepeatDetector::Verdict::Stuck) return kStuck;
  return is_saturated ? kSaturated : std::string();
}

void InertialScreen::leaveOut(const std::string& kind, const ImuSample& sample) {
  if (stretch_.readings == 0) stretch_ = {kind, sample.time, sample.time, 0};
  ++stretch_.readings;
  stretch_.last = sample.time;
  if (kind == kHeld) {
    // Single repetitions are not reported; many mean that the sensor measures more slowly than stated.
    constexpr double kWorthSaying = 0.05;
    constexpr int64_t kLeast = 50;
    ++held_;
    if (static_cast<double>(held_) < kWorthSaying * static_cast<double>(readings_) || held_ < kLeast) return;
    diagnostics_->report(
        Severity::Warning, kind,
        fmt::format(
            "up to stamp {} ns {} of {} inertial readings are {}; they are left out, and what is left is "
            "that much slower than the IMU's stated rate",
            sample.time.nanoseconds(), held_, readings_, reasonOf(kind)));
    return;
  }
  diagnostics_->report(kind == kStuck ? Severity::Serious : Severity::Warning, kind,
                       fmt::format("inertial reading at {} ns, {}: {}; left out, and interpolated over",
                                   sample.time.nanoseconds(), valuesOf(sample), reasonOf(kind)));
}

void InertialScreen::closeStretch(const std::string& next_kind) {
  const double length_s = (stretch_.last - stretch_.first).seconds();
  if (stretch_.readings > 0 && length_s > kGap_s) {
    diagnostics_->report(
        Severity::Serious, "imu_unusable",
        fmt::format(
            "no usable inertial reading for {:.3g} s after {} ns: {} readings are {}; the motion within is "
            "taken for unknown",
            length_s, stretch_.first.nanoseconds(), stretch_.readings, reasonOf(stretch_.kind)));
  }
  stretch_ = {};
  stretch_.kind = next_kind;
}

std::vector<ImuSample> screened(const std::vector<ImuSample>& samples, const InertialScreenOptions& options,
                                Diagnostics* diagnostics) {
  size_t next = 0;
  InertialScreen screen(
      [&]() -> std::optional<ImuSample> {
        if (next == samples.size()) return std::nullopt;
        return samples[next++];
      },
      options, diagnostics);
  std::vector<ImuSample> result;
  while (screen.peek() != nullptr) result.push_back(screen.pop());
  return result;
}

}  // namespace lodeline

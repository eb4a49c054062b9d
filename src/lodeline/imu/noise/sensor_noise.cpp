#include "lodeline/imu/noise/sensor_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

constexpr size_t kReadingsForPeriod = 65;
constexpr int64_t kFewestReadings = 256;
constexpr double kGapPeriods = 3.0;
constexpr double kGapPauses = 1.5;  ///< multiple of the usual pause between bursts
constexpr double kLongestFilledGap_s = 1.0;
constexpr double kWorthReporting = 0.01;  ///< fraction of readings
constexpr double kMovedTooMuch = 0.5;     ///< fraction of windows
constexpr double kGoodWhite = 0.05;       ///< relative sigma
constexpr double kGoodSlow = 0.30;

}  // namespace

AnalysedSensor gyroscopeToAnalyse() { return {"gyroscope", "rad/s", {0.02, 0.005}}; }
AnalysedSensor accelerometerToAnalyse() { return {"accelerometer", "m/s^2", {0.15, 0.03}}; }
AnalysedSensor magnetometerToAnalyse() { return {"magnetometer", "T", {3e-6, 0.3e-6}}; }

SensorNoiseAnalysis::SensorNoiseAnalysis(AnalysedSensor sensor, Diagnostics* diagnostics)
    : sensor_(std::move(sensor)), diagnostics_(diagnostics), stillness_(sensor_.still) {}

void SensorNoiseAnalysis::add(Time time, const Vec3& reading) {
  if (!reading.allFinite()) {
    diagnostics_->report(
        Severity::Warning, sensor_.name + "_not_finite",
        fmt::format("{}: reading at {} ns is not finite; passed over", sensor_.name, time.nanoseconds()));
    return;
  }
  if (stamps_.size() < kStampsForRate) stamps_.push_back(time);
  if (begin_ && time <= last_time_) {
    ++disordered_;
    diagnostics_->report(Severity::Warning, sensor_.name + "_disorder",
                         fmt::format("{}: stamp {} ns does not follow on {} ns; reading passed over",
                                     sensor_.name, time.nanoseconds(), last_time_.nanoseconds()));
    return;
  }
  if (!begin_) begin_ = time;
  last_time_ = time;
  if (period_s_ > 0.0) {
    if (!isSpike(time, reading)) take(time, reading);
    return;
  }
  first_.emplace_back(time, reading);
  if (first_.size() == kReadingsForPeriod) learnPeriod();
}

void SensorNoiseAnalysis::learnPeriod() {
  std::vector<double> steps_s;
  for (size_t i = 1; i < first_.size(); ++i) {
    steps_s.push_back((first_[i].first - first_[i - 1].first).seconds());
  }
  std::sort(steps_s.begin(), steps_s.end());
  // The mean instead of the median, because readings in bursts have mostly tiny steps. The longest step may
  // be a gap.
  const double longest_s = steps_s.size() > 1 ? steps_s.back() : 0.0;
  const double sum_s = (first_.back().first - first_.front().first).seconds() - longest_s;
  period_s_ = sum_s / static_cast<double>(std::max<size_t>(1, steps_s.size() - (longest_s > 0.0 ? 1 : 0)));
  const double usual_s = steps_s[steps_s.size() * 15 / 16];
  gap_limit_s_ = std::max(kGapPeriods * period_s_, kGapPauses * usual_s);
  const auto waiting = std::exchange(first_, {});
  for (const auto& [time, reading] : waiting) take(time, reading);
}

bool SensorNoiseAnalysis::isSpike(Time time, const Vec3& reading) {
  constexpr double kFar = 100.0;  // multiple of the scatter of a stationary sensor
  constexpr int kSpikes = 2;      // more consecutive ones are not a spike
  const bool is_far = (reading - last_).norm() > kFar * sensor_.still.largest_std;
  spikes_ = is_far ? spikes_ + 1 : 0;
  if (!is_far || spikes_ > kSpikes) return false;
  diagnostics_->report(Severity::Warning, sensor_.name + "_spike",
                       fmt::format("{}: reading at {} ns lies {:.3g} {} off the one before; passed over",
                                   sensor_.name, time.nanoseconds(), (reading - last_).norm(), sensor_.unit));
  return true;
}

void SensorNoiseAnalysis::take(Time time, const Vec3& reading) {
  bool is_repeated = false;
  if (readings_ > 0) {
    bridge(time, reading);
    is_repeated = reading == last_;
    repeated_ += is_repeated ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis)
      repeated_axis_[static_cast<size_t>(axis)] += reading[axis] == last_[axis] ? 1 : 0;
  }
  all_readings_.add(reading);
  if (!is_repeated) fresh_readings_.add(reading);
  stillness_.add(time, reading);
  ++readings_;
  previous_time_ = time;
  last_ = reading;
}

void SensorNoiseAnalysis::bridge(Time time, const Vec3& reading) {
  const double gap_s = (time - previous_time_).seconds();
  if (gap_s < gap_limit_s_) return;
  const bool is_filled = gap_s <= kLongestFilledGap_s;
  diagnostics_->report(Severity::Warning, sensor_.name + "_gap",
                       fmt::format("{}: {:.3f} s without readings after {} ns; {}", sensor_.name, gap_s,
                                   previous_time_.nanoseconds(),
                                   is_filled ? "interpolated" : "no averaging time spans the gap"));
  if (!is_filled) {
    split_s_ += gap_s - period_s_;
    all_readings_.breakOff();
    fresh_readings_.breakOff();
    return;
  }
  const double fresh_share =
      static_cast<double>(fresh_readings_.count()) / static_cast<double>(all_readings_.count());
  const auto fill = [&](AllanAccumulator* readings, double share) {
    const auto missing = std::llround(share * gap_s / period_s_) - 1;
    for (int64_t i = 1; i <= missing; ++i) {
      const double at = static_cast<double>(i) / static_cast<double>(missing + 1);
      readings->add(last_ + at * (reading - last_));
    }
  };
  fill(&all_readings_, 1.0);
  fill(&fresh_readings_, fresh_share);
}

bool SensorNoiseAnalysis::holdsReadings() const {
  // Model: a fraction h of readings is held; in the others, each axis repeats independently with probability
  // q due to coarse resolution. Then an axis repeats in p = h + (1 - h) q of the readings, and all three
  // together in j = h + (1 - h) q^3. So (1 - j) / (1 - p) = 1 + q + q^2. The axis with the fewest repetitions
  // gives p, because an axis that is not measured always repeats.
  const auto count = static_cast<double>(std::max<int64_t>(1, readings_ - 1));
  const double p =
      static_cast<double>(*std::min_element(repeated_axis_.begin(), repeated_axis_.end())) / count;
  const double j = static_cast<double>(repeated_) / count;
  if (p >= 1.0) return true;
  const double ratio = std::max(1.0, (1.0 - j) / (1.0 - p));
  const double q = 0.5 * (std::sqrt(4.0 * ratio - 3.0) - 1.0);
  const double h = q < 1.0 ? 1.0 - (1.0 - p) / (1.0 - q) : 0.0;
  return h > kWorthReporting && h > 0.5 * j;
}

SensorNoise SensorNoiseAnalysis::analysed() const {
  SensorNoise noise;
  noise.sensor = sensor_;
  noise.readings = readings_;
  noise.stillness = stillness_.result();
  noise.duration_s = readings_ > 0 ? (last_time_ - *begin_).seconds() - split_s_ : 0.0;
  const bool holds = holdsReadings();
  noise.repeated = holds ? repeated_ : 0;
  const AllanAccumulator& used = holds ? fresh_readings_ : all_readings_;
  if (used.count() < 2 || noise.duration_s <= 0.0) return noise;
  const double interval_s = noise.duration_s / static_cast<double>(used.count() - 1);
  noise.rate_hz = 1.0 / interval_s;
  noise.curve = used.curve(interval_s);
  return noise;
}

SensorNoise SensorNoiseAnalysis::finish() {
  if (period_s_ == 0.0 && first_.size() > 1) learnPeriod();
  SensorNoise noise = analysed();
  requireAnalysable(noise);
  for (int axis = 0; axis < 3; ++axis) {
    const auto fit = fitNoise(noise.curve, axis);
    if (fit) {
      noise.axes[static_cast<size_t>(axis)] = *fit;
      continue;
    }
    diagnostics_->report(
        Severity::Serious, sensor_.name + "_axis_silent",
        fmt::format("{}: axis {} does not vary; is it read at all?", sensor_.name, "xyz"[axis]));
  }
  const auto all = fitNoise(noise.curve, std::nullopt);
  if (!all) {
    throw InputError(
        fmt::format("{}: readings do not vary over {:.0f} s; the sensor is frozen, or its "
                    "resolution is too coarse to show noise",
                    sensor_.name, noise.duration_s));
  }
  noise.all = *all;
  reportConditions(noise);
  reportFit(noise);
  return noise;
}

void SensorNoiseAnalysis::requireAnalysable(const SensorNoise& noise) const {
  if (readings_ < kFewestReadings) {
    const int64_t usable = std::max<int64_t>(readings_, static_cast<int64_t>(first_.size()));
    if (disordered_ > usable) {
      refuseBadClock(sensor_.name, stamps_);
      throw InputError(
          fmt::format("{}: {} of {} readings have no later time than one before them; check the "
                      "column of the times and sort the record by it",
                      sensor_.name, disordered_, disordered_ + usable));
    }
    throw InputError(
        fmt::format("{}: {} usable readings, at least {} are needed, and hours for bias "
                    "instability; record the rig lying still",
                    sensor_.name, usable, kFewestReadings));
  }
  if (noise.readings - noise.repeated < kFewestReadings) {
    throw InputError(fmt::format("{}: frozen: {} of {} readings only repeat the one before", sensor_.name,
                                 noise.repeated, noise.readings));
  }
  if (noise.stillness.movedShare() > kMovedTooMuch) {
    throw InputError(fmt::format(
        "{}: not still: moved in {:.0f} % of the record (first at {} ns); noise can "
        "only be told from motion at rest: lay the rig on solid ground",
        sensor_.name, 100.0 * noise.stillness.movedShare(), noise.stillness.first_moved->nanoseconds()));
  }
}

void SensorNoiseAnalysis::reportConditions(const SensorNoise& noise) const {
  const auto report = [&](Severity severity, const char* kind, const std::string& message) {
    diagnostics_->report(severity, sensor_.name + kind, sensor_.name + ": " + message);
  };
  if (noise.repeated > 0) {
    report(Severity::Warning, "_repeated",
           fmt::format("{:.1f} % of the readings repeat the one before and were left out; it measures at "
                       "{:.1f} Hz",
                       100.0 * static_cast<double>(noise.repeated) / static_cast<double>(noise.readings),
                       noise.rate_hz));
  }
  if (noise.stillness.moved > 0) {
    report(Severity::Serious, "_moved",
           fmt::format("not still in {} of {} stretches of 10 s, first at {} ns: the figures are too large; "
                       "leave that part out or record anew",
                       noise.stillness.moved, noise.stillness.windows,
                       noise.stillness.first_moved->nanoseconds()));
  }
}

void SensorNoiseAnalysis::reportFit(const SensorNoise& noise) const {
  const NoiseFit& fit = noise.all;
  const auto report = [&](Severity severity, const char* kind, const std::string& message) {
    diagnostics_->report(severity, sensor_.name + kind, sensor_.name + ": " + message);
  };
  if (fit.lacks_white_region) {
    report(Severity::Serious, "_no_white_noise",
           "no averaging time shows white noise; its figure says nothing (filtered, or vibrating ground)");
  } else if (fit.is_filtered) {
    report(
        Severity::Warning, "_filtered",
        fmt::format("filtered in the sensor: averages as white noise only from {:.3g} s on; single readings "
                    "scatter less than density * sqrt(rate)",
                    fit.shortest_s));
  }
  if (fit.ramp.value > 0.0) {
    report(Severity::Warning, "_drift",
           fmt::format("drifts steadily by {:.2g} {} an hour: temperature or warming up; leave the first "
                       "minutes out (--from)",
                       3600.0 * fit.ramp.value, sensor_.unit));
  }
  const auto claim = [&](const NoiseFigure& figure, const char* kind, const char* what, double good) {
    if (figure.resolved && figure.sigma <= good * figure.value) return;
    const std::string known = figure.resolved
                                  ? fmt::format("known to {:.0f} % only", 100.0 * figure.sigma / figure.value)
                                  : "the figure is an upper bound";
    report(Severity::Warning, kind,
           fmt::format("{:.2g} h are too short for the {}: {}", noise.duration_s / 3600.0, what, known));
  };
  claim(fit.white, "_short_for_white_noise", "white noise", kGoodWhite);
  claim(fit.instability, "_short_for_instability", "bias instability", kGoodSlow);
  claim(fit.walk, "_short_for_walk", "random walk", kGoodSlow);
}

}  // namespace lodeline

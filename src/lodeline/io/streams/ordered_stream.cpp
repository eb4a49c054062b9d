#include "lodeline/io/streams/ordered_stream.h"

#include <fmt/core.h>

#include <bit>
#include <cstdlib>
#include <initializer_list>
#include <span>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

/// A step of more periods may contain a missing reading.
constexpr double kHolePeriods = 1.5;
/// Minimum step between consecutive readings of one sensor, as a fraction of a period.
constexpr double kTooClose = 0.6;

uint64_t keyOf(std::span<const double> values) {
  uint64_t key = 0;
  for (const double value : values) key = (key ^ std::bit_cast<uint64_t>(value)) * 0x9e3779b97f4a7c15u;
  return key;
}
uint64_t keyOf(std::initializer_list<double> values) {
  return keyOf(std::span(values.begin(), values.size()));
}

}  // namespace

uint64_t contentKey(const ImuSample& sample) {
  const Vec3& w = sample.angular_velocity_B;
  const Vec3& f = sample.specific_force_B;
  return keyOf({w.x(), w.y(), w.z(), f.x(), f.y(), f.z()});
}
uint64_t contentKey(const MagnetometerSample& sample) {
  return keyOf({sample.field_M.x(), sample.field_M.y(), sample.field_M.z()});
}
uint64_t contentKey(const DepthSample& sample) { return keyOf({sample.depth_m}); }
uint64_t contentKey(const SonarSample& sample) { return keyOf({sample.range_m, sample.angle_rad}); }
uint64_t contentKey(const AltimeterSample& sample) { return keyOf({sample.range_m}); }
uint64_t contentKey(const DvlSample& sample) {
  const Vec3 velocity_D = sample.velocity_D.value_or(Vec3::Zero());
  std::vector<double> values = {velocity_D.x(), velocity_D.y(), velocity_D.z()};
  for (const DvlBeam& beam : sample.beams) {
    values.push_back(beam.velocity_m_per_s.value_or(0.0));
    values.push_back(beam.range_m.value_or(0.0));
  }
  return keyOf(values);
}
uint64_t contentKey(const CurrentSample& sample) { return keyOf(sample.currents_A); }

Duration StampMonitor::period() const {
  return expectation_.rate_hz > 0.0 ? Duration::fromSeconds(1.0 / expectation_.rate_hz) : last_step_;
}

bool StampMonitor::isHole(Time time) const {
  if (expectation_.look_ahead == 0 || !last_) return false;
  return span(time, *last_).seconds() > kHolePeriods * period().seconds();
}

void StampMonitor::accept(Time time) {
  if (last_) last_step_ = span(time, *last_);
  if (last_ && expectation_.max_gap_s > 0.0 && last_step_.seconds() > expectation_.max_gap_s) {
    diagnostics_->report(
        Severity::Warning, expectation_.kind + "_gap",
        fmt::format("{}: nothing for {:.3f} s after stamp {} ns (nominally {:g} Hz)", expectation_.name,
                    last_step_.seconds(), last_->nanoseconds(), expectation_.rate_hz));
  }
  last_ = time;
}

bool StampMonitor::overlaps(const std::vector<Time>& batch, const std::vector<Time>& others) const {
  const double close_s = kTooClose * period().seconds();
  size_t close = 0;
  for (const Time time : batch) {
    close += std::any_of(others.begin(), others.end(),
                         [&](Time other) { return std::abs(span(other, time).seconds()) < close_s; })
                 ? 1
                 : 0;
  }
  return 2 * close >= batch.size();
}

void StampMonitor::reportDuplicate(Time time) const {
  diagnostics_->report(Severity::Warning, expectation_.kind + "_duplicate",
                       fmt::format("{}: stamp {} ns occurs more than once; only the first is used",
                                   expectation_.name, time.nanoseconds()));
}

void StampMonitor::reportDisorder(Time former, Time latter, Fate fate) const {
  const char* what = fate == Fate::PutInPlace ? "the latter is put in its place"
                     : fate == Fate::Dropped  ? "the latter is dropped"
                                              : "the former is dropped";
  diagnostics_->report(Severity::Warning, expectation_.kind + "_disorder",
                       fmt::format("{}: time goes backwards from stamp {} ns to {} ns; {}", expectation_.name,
                                   former.nanoseconds(), latter.nanoseconds(), what));
}

void StampMonitor::reportJumpBack(Time former, Time latter) const {
  diagnostics_->report(
      Severity::Warning, expectation_.kind + "_clock_jump",
      fmt::format(
          "{}: the clock was set back by {:.6g} s, from stamp {} ns to {} ns; the readings from there "
          "on are taken to follow without a pause",
          expectation_.name, span(former, latter).seconds() + period().seconds(), former.nanoseconds(),
          latter.nanoseconds()));
}

void StampMonitor::reportBursts(Duration period, Time first) const {
  diagnostics_->report(
      Severity::Warning, expectation_.kind + "_bursts",
      fmt::format(
          "{}: from stamp {} ns on the readings come in bursts, stamped when they arrived, or several "
          "share a stamp (mean rate {:.4g} Hz); they are spread out over the time since the burst "
          "before. Stamps of the sensor itself are better: a delay of the whole burst stays",
          expectation_.name, first.nanoseconds(), 1.0 / period.seconds()));
}

void StampMonitor::refuseReversal(Time former, Time latter) const {
  throw InputError(storedInReverse(expectation_.name, former, latter));
}

}  // namespace lodeline

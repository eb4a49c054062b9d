#include "lodeline/io/robots/dvl_screen.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

/// -32768 mm/s, with the rounding of a 32-bit number.
constexpr double kRdiBad_m_per_s = -32.768, kRdiRounding_m_per_s = 1e-5;
/// Written by drivers beside NaN and 0.
constexpr double kOtherBad_m_per_s = -2.0;
constexpr int kFewestBeamsOfVector = 3;
/// Faster than any vehicle that measures its velocity against the ground.
constexpr double kGreatestVelocity_m_per_s = 15.0;

bool isBad(double velocity_m_per_s) {
  return !std::isfinite(velocity_m_per_s) ||
         std::abs(velocity_m_per_s - kRdiBad_m_per_s) < kRdiRounding_m_per_s;
}

bool isSuspect(double velocity_m_per_s) {
  return velocity_m_per_s == 0.0 || velocity_m_per_s == kOtherBad_m_per_s;
}

std::optional<double> velocityOf(const StatedDvlBeam& beam) {
  const double velocity = beam.velocity_m_per_s;
  if (!beam.is_valid.value_or(true) || isBad(velocity)) return std::nullopt;
  const bool has_no_echo = std::isfinite(beam.range_m) && beam.range_m <= 0.0;
  if (isSuspect(velocity) && (has_no_echo || !beam.is_valid)) return std::nullopt;
  return velocity;
}

std::optional<double> rangeOf(const StatedDvlBeam& beam) {
  if (!beam.is_valid.value_or(true) || !std::isfinite(beam.range_m) || beam.range_m <= 0.0)
    return std::nullopt;
  return beam.range_m;
}

int lockedBeams(const std::vector<DvlBeam>& beams) {
  return static_cast<int>(std::count_if(
      beams.begin(), beams.end(), [](const DvlBeam& beam) { return beam.velocity_m_per_s.has_value(); }));
}

std::optional<Vec3> velocityOf(const StatedDvlPing& ping, const std::vector<DvlBeam>& beams) {
  if (!ping.velocity_D || !ping.is_velocity_valid.value_or(true)) return std::nullopt;
  const Vec3& v = *ping.velocity_D;
  if (isBad(v.x()) || isBad(v.y()) || isBad(v.z())) return std::nullopt;
  const bool are_equal = v.x() == v.y() && v.y() == v.z();
  if (!ping.is_velocity_valid && are_equal && isSuspect(v.x())) return std::nullopt;
  const bool states_beams = beams.size() >= kFewestBeamsOfVector;
  if (states_beams && lockedBeams(beams) < kFewestBeamsOfVector) return std::nullopt;
  return v;
}

}  // namespace

DvlSample withoutSentinels(const StatedDvlPing& ping) {
  DvlSample sample;
  sample.time = ping.time;
  sample.track = ping.track;
  for (const StatedDvlBeam& beam : ping.beams)
    sample.beams.push_back({beam.index, velocityOf(beam), rangeOf(beam)});
  sample.velocity_D = velocityOf(ping, sample.beams);
  const double sigma = ping.velocity_sigma_m_per_s;
  if (sample.velocity_D && std::isfinite(sigma) && sigma > 0.0) sample.velocity_sigma_m_per_s = sigma;
  return sample;
}

void countBeamsFromZero(StatedDvlPing* ping) {
  int least = std::numeric_limits<int>::max(), greatest = 0;
  for (const StatedDvlBeam& beam : ping->beams) {
    least = std::min(least, beam.index);
    greatest = std::max(greatest, beam.index);
  }
  if (least != 1 || greatest != static_cast<int>(ping->beams.size())) return;
  for (StatedDvlBeam& beam : ping->beams) --beam.index;
}

void DvlLock::add(const DvlSample& ping) {
  const auto locked = static_cast<size_t>(lockedBeams(ping.beams));
  ++pings;
  if (!ping.velocity_D && locked == 0) ++without_lock;
  if (locked > 0 && locked < ping.beams.size()) ++partial;
}

DvlSample DvlScreen::screened(const StatedDvlPing& ping) {
  DvlSample sample = withoutSentinels(ping);
  std::erase_if(sample.beams, [&](const DvlBeam& beam) {
    if (beam.index >= 0 && static_cast<size_t>(beam.index) < beam_count_) return false;
    diagnostics_->report(
        Severity::Warning, "dvl_beam_unknown",
        fmt::format("{}: beam {} at {} ns is left out: the calibration has {} beams, counted from 0", name_,
                    beam.index, sample.time.nanoseconds(), beam_count_));
    return true;
  });
  lock_.add(sample);
  checkUnit(sample);
  return sample;
}

void DvlScreen::checkUnit(const DvlSample& ping) {
  if (is_unit_doubted_) return;
  double greatest = ping.velocity_D ? ping.velocity_D->norm() : 0.0;
  for (const DvlBeam& beam : ping.beams)
    greatest = std::max(greatest, std::abs(beam.velocity_m_per_s.value_or(0.0)));
  if (greatest < kGreatestVelocity_m_per_s) return;
  is_unit_doubted_ = true;
  diagnostics_->report(Severity::Warning, "dvl_unit",
                       fmt::format("{}: a velocity of {:g} m/s at {} ns, which no vehicle has: is it in m/s?",
                                   name_, greatest, ping.time.nanoseconds()));
}

void DvlScreen::finish() {
  if (is_finished_) return;
  is_finished_ = true;
  if (lock_.without_lock + lock_.partial == 0) return;
  const double share = static_cast<double>(lock_.without_lock) / lock_.pings;
  constexpr double kMostPings = 0.5;
  diagnostics_->report(
      share < kMostPings ? Severity::Notice : Severity::Warning, "dvl_no_lock",
      fmt::format("{}: {} of {} pings ({:.1f} %) have no lock; {} ({:.1f} %) lack some beams", name_,
                  lock_.without_lock, lock_.pings, 100.0 * share, lock_.partial,
                  100.0 * lock_.partial / lock_.pings));
}

}  // namespace lodeline

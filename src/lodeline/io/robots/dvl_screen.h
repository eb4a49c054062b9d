#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

/// One beam as an instrument states it. Numbers that it does not state are NaN.
struct StatedDvlBeam {
  int index = 0;
  double velocity_m_per_s = std::numeric_limits<double>::quiet_NaN();
  double range_m = std::numeric_limits<double>::quiet_NaN();
  std::optional<bool> is_valid = std::nullopt;
};

/// One ping of a DVL as an instrument states it, with the numbers that it writes where it has no lock.
struct StatedDvlPing {
  Time time;
  DvlTrack track = DvlTrack::Bottom;
  std::optional<Vec3> velocity_D = std::nullopt;
  std::optional<bool> is_velocity_valid = std::nullopt;
  double velocity_sigma_m_per_s = std::numeric_limits<double>::quiet_NaN();
  std::vector<StatedDvlBeam> beams;
};

/// Removes the numbers that mean "no lock". They are NaN, -32.768 m/s (-32768 mm/s of RDI's format PD0),
/// ranges of 0 or less (-1 and -2 of several drivers), and all stated as not valid. Velocities of exactly 0
/// or -2 m/s on all axes, or along a beam, count as well where no validity is stated. A velocity of one or
/// two beams is removed, because it is no vector.
DvlSample withoutSentinels(const StatedDvlPing& ping);

/// Numbers the beams of a ping from 0 where the instrument counts all of them from 1.
void countBeamsFromZero(StatedDvlPing* ping);

/// Share of pings with a lock.
struct DvlLock {
  int pings = 0;
  int without_lock = 0;  ///< neither a velocity nor the velocity of a beam
  int partial = 0;       ///< without the velocity of at least one beam, but not of all

  void add(const DvlSample& ping);
};

/// Screens the pings of a recording, counts them, and reports what it removed: `dvl_no_lock` at the end of
/// the stream, `dvl_beam_unknown` for beams that the calibration does not have, and `dvl_unit` for velocities
/// that no vehicle has.
class DvlScreen {
 public:
  /// `name`: of the stream, for messages. `diagnostics` must outlive the object.
  DvlScreen(std::string name, size_t beam_count, Diagnostics* diagnostics)
      : name_(std::move(name)), beam_count_(beam_count), diagnostics_(diagnostics) {}

  DvlSample screened(const StatedDvlPing& ping);
  /// Reports the share of pings without lock; once.
  void finish();

 private:
  void checkUnit(const DvlSample& ping);

  std::string name_;
  size_t beam_count_;
  Diagnostics* diagnostics_;
  DvlLock lock_;
  bool is_finished_ = false, is_unit_doubted_ = false;
};

}  // namespace lodeline

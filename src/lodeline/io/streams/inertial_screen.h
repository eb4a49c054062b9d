#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/reading_history.h"
#include "lodeline/io/streams/repeat_detector.h"
#include "lodeline/io/streams/saturation_detector.h"
#include "lodeline/io/streams/unit_change.h"
#include "lodeline/rig.h"

namespace lodeline {

struct InertialScreenOptions {
  /// Factor from the gyroscope's unit to rad/s.
  double rate_to_SI = 1.0;
  /// Whether the limits in rad/s apply to the gyroscope's readings.
  bool knows_rate_unit = true;
  /// Leaves out readings that repeat the one before. False for callers that count repetitions themselves.
  bool drops_repeats = true;
};

/// Rejects and converts inertial readings at the input of every source, before any computation. It rejects:
/// readings that no sensor can give (not finite, beyond every range, all zeros); spikes against the readings
/// before and after; repetitions of the reading before; readings of a gyroscope or accelerometer that is
/// stuck while the other one moves; and readings at the end of a sensor's range. Users of the stream
/// interpolate over missing readings and treat longer stretches as gaps with unknown motion. It converts
/// accelerometers in g or mg, gyroscopes in deg/s where `rate_to_SI` says so, and units and signs of axes
/// that change within the stream. It reports every such reading with its stamp and values.
///
/// A reading passes immediately unless it jumps against those before; the screen then waits for up to
/// kUnitReadings further ones. Memory use is constant.
class InertialScreen {
 public:
  using Pull = std::function<std::optional<ImuSample>()>;

  /// `pull` gives readings in order of time; `diagnostics` must outlive the screen.
  InertialScreen(Pull pull, const InertialScreenOptions& options, Diagnostics* diagnostics)
      : pull_(std::move(pull)), options_(options), diagnostics_(diagnostics) {}

  /// The next reading without removal from the stream; null at the end.
  const ImuSample* peek();
  /// Removes and returns the next reading; valid only after peek() has returned one.
  ImuSample pop();

 private:
  /// Consecutive readings that were rejected for one reason.
  struct Stretch {
    std::string kind;
    Time first, last;
    int readings = 0;
  };

  bool fetch(size_t readings);
  bool isPossible(const ImuSample& sample) const;
  void settleUnit();
  /// Reason to reject the front reading, as the kind of a finding; empty where it is accepted.
  std::string objection();
  std::string jumpObjection();
  std::string repetition(const ImuSample& sample);
  void convertPending(const ReadingFactors& factors);
  void leaveOut(const std::string& kind, const ImuSample& sample);
  void closeStretch(const std::string& next_kind);

  Pull pull_;
  InertialScreenOptions options_;
  Diagnostics* diagnostics_;
  ReadingFactors factors_;  ///< factors for later readings
  bool is_unit_settled_ = false;
  bool has_ended_ = false;
  std::deque<ImuSample> pending_;  ///< converted, not screened yet
  size_t spikes_ahead_ = 0;        ///< number of these known to be spikes
  std::optional<ImuSample> head_;
  ReadingHistory history_;
  RepeatDetector repeats_;
  SaturationDetector saturation_;
  Stretch stretch_;
  int64_t readings_ = 0, held_ = 0;
};

/// Screens a complete list of readings in order of time.
std::vector<ImuSample> screened(const std::vector<ImuSample>& samples, const InertialScreenOptions& options,
                                Diagnostics* diagnostics);

}  // namespace lodeline

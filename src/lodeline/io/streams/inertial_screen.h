#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/streams/reading_history.h"
#include "lodeline/io/streams/repeat_detector.h"
#include "lodeline/io/streams/saturation_detector.h"
#include "lodeline/io/streams/unit_change.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct InertialScreenOptions {
  /// Takes the gyroscope's readings to rad/s, where their unit is known to be another.
  double rate_to_SI = 1.0;
  /// Whether the gyroscope's readings may be held to what sensors can measure in rad/s.
  bool knows_rate_unit = true;
  /// Leaves out what repeats the reading before. Off for those who count repetitions themselves.
  bool drops_repeats = true;
};

/// Judges inertial readings where they enter, the same for every source, before anything is computed from
/// them. Left out are readings that no sensor can give (not finite, beyond every range, rows of zeros),
/// spikes against the readings before and after, readings that repeat the one before, those of a gyroscope or
/// accelerometer that hangs while the other moves, and readings at the end of a sensor's range. Whoever uses
/// the stream interpolates over what is missing, and takes longer stretches for gaps, in which the motion is
/// unknown. Converted are accelerometers in g or mg, gyroscopes in deg/s as far as `rate_to_SI` says so, and
/// units and signs of axes that change in mid-stream. Every such reading is reported with its stamp and
/// values.
///
/// A reading passes at once unless it jumps against those before; then up to kUnitReadings further ones are
/// waited for. Memory is constant.
class InertialScreen {
 public:
  using Pull = std::function<std::optional<ImuSample>()>;

  /// `pull` gives readings in order of time; `diagnostics` must outlive the screen.
  InertialScreen(Pull pull, const InertialScreenOptions& options, Diagnostics* diagnostics)
      : pull_(std::move(pull)), options_(options), diagnostics_(diagnostics) {}

  /// The next reading, left in the stream; null at the end.
  const ImuSample* peek();
  /// Takes the next reading out; only after peek() has shown that there is one.
  ImuSample pop();

 private:
  /// Readings left out for one reason, since the last that was not.
  struct Stretch {
    std::string kind;
    Time first, last;
    int readings = 0;
  };

  bool fetch(size_t readings);
  bool isPossible(const ImuSample& sample) const;
  void settleUnit();
  /// Why the front reading must not be used: a finding's kind; empty where it may be.
  std::string objection();
  std::string jumpObjection();
  std::string repetition(const ImuSample& sample);
  void convertPending(const ReadingFactors& factors);
  void leaveOut(const std::string& kind, const ImuSample& sample);
  void closeStretch(const std::string& next_kind);

  Pull pull_;
  InertialScreenOptions options_;
  Diagnostics* diagnostics_;
  ReadingFactors factors_;  ///< of readings to come
  bool is_unit_settled_ = false;
  bool has_ended_ = false;
  std::deque<ImuSample> pending_;  ///< converted, not yet judged
  size_t spikes_ahead_ = 0;        ///< of these, known to be spikes
  std::optional<ImuSample> head_;
  ReadingHistory history_;
  RepeatDetector repeats_;
  SaturationDetector saturation_;
  Stretch stretch_;
  int64_t readings_ = 0, held_ = 0;
};

/// The same for readings that are at hand, in order of time.
std::vector<ImuSample> screened(const std::vector<ImuSample>& samples, const InertialScreenOptions& options,
                                Diagnostics* diagnostics);

}  // namespace lodeline

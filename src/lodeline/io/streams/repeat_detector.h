#pragma once

#include <optional>

#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// Tells readings that a driver held, or that a sensor that hangs repeats, from those of a sensor that
/// resolves coarsely at rest. The coarse one repeats single axes about as often as all of them together; a
/// fresh reading of the other kind hardly shares an axis with the one before.
class RepeatDetector {
 public:
  enum class Verdict {
    Fresh,  ///< or not to be told from it
    Held,   ///< gyroscope and accelerometer both repeat the reading before
    Stuck,  ///< one of the two repeats itself for long while the other moves
  };

  /// Readings in order, each once.
  Verdict judge(const ImuSample& sample);

 private:
  /// Repetition of one of gyroscope and accelerometer.
  class Triad {
   public:
    /// `other`: reading of the other one.
    void add(const Vec3& before, const Vec3& reading, const Vec3& other, Time time);
    bool repeats() const { return repeats_; }
    bool resolvesFinely() const { return share_ < 0.5; }
    /// Since when it has repeated itself, while the other one changed by more than `moving` in an axis.
    bool isStuck(Time now, double moving) const;

   private:
    bool has_changed_ = false;
    double share_ = 1.0;  ///< of axes that repeat, in readings of which not all do: running mean
    bool repeats_ = false;
    Time since_;
    Vec3 other_least_ = Vec3::Zero(), other_greatest_ = Vec3::Zero();
  };

  std::optional<ImuSample> before_;
  Triad gyroscope_, accelerometer_;
};

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/rig.h"

namespace lodeline {

/// Detects readings repeated by a driver or by a stuck sensor, as opposed to equal readings of a coarsely
/// quantized sensor at rest. With coarse quantization, single axes repeat about as often as all axes
/// together. With a driver that repeats, a new reading almost never shares an axis with the one before.
class RepeatDetector {
 public:
  enum class Verdict {
    Fresh,  ///< new, or not distinguishable from a new reading
    Held,   ///< gyroscope and accelerometer both repeat the reading before
    Stuck,  ///< one of the two repeats for long while the other moves
  };

  /// Classifies the next reading; call once per reading, in order.
  Verdict judge(const ImuSample& sample);

 private:
  /// Repetition state of one sensor (gyroscope or accelerometer).
  class Triad {
   public:
    /// `other`: reading of the other sensor.
    void add(const Vec3& before, const Vec3& reading, const Vec3& other, Time time);
    bool repeats() const { return repeats_; }
    bool resolvesFinely() const { return share_ < 0.5; }
    /// Whether this sensor has repeated for long while an axis of the other one changed by more than
    /// `moving`.
    bool isStuck(Time now, double moving) const;

   private:
    bool has_changed_ = false;
    double share_ = 1.0;  ///< mean fraction of repeated axes, where not all repeat
    bool repeats_ = false;
    Time since_;
    Vec3 other_least_ = Vec3::Zero(), other_greatest_ = Vec3::Zero();
  };

  std::optional<ImuSample> before_;
  Triad gyroscope_, accelerometer_;
};

}  // namespace lodeline

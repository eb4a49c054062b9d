#pragma once

#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Size of the anomaly (iron, magnetic rock, steel) that the field taken for the Earth's may contain. Such a
/// field changes over metres, so the way of the rig counts and not the time.
///
/// The first field may be that of iron nearby: b is kStart_T. It decreases by exp(-way / kLength_m). It
/// increases to a deviation of size and dip that is significant, and to one of the heading where the gate
/// rejects the reading. The way of agreement confirms the field:
///   sigma = b exp(-way of agreement / kConfirmed_m).
class AnomalyScale {
 public:
  static constexpr double kStart_T = 3.5e-6;
  static constexpr double kMost_T = 10e-6;
  static constexpr double kLength_m = 2.0;
  static constexpr double kConfirmed_m = 4.0;

  /// Measured minus expected field as a mean over a second, T.
  struct Deviation {
    Vec2 size_and_dip_T = Vec2::Zero();
    double variance_T2 = 0.0;  ///< of each of the two, by noise and the expectation
    double across_T = 0.0;     ///< horizontal, across the field: the heading's
  };
  /// Adds a reading at a place. `agrees`: the gate accepted the field as the Earth's.
  void add(const Vec3& position_W, const Deviation& deviation, bool agrees);

  /// One sigma of an axis of the anomaly in the field in force, T.
  double sigma_T() const;

  /// Another field is in force; nothing has confirmed it yet.
  void restartAgreement() { agreed_m_ = 0.0; }

 private:
  double in_force_T_ = kStart_T;
  double agreed_m_ = 0.0;
  std::optional<Vec3> anchor_W_;  ///< place up to which the way was counted
};

}  // namespace lodeline

#pragma once

#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Size of the anomalous field (iron, magnetic rock, steel) near the rig, and the anomaly that the field
/// taken for the Earth's may itself contain. Both change over metres, so both are weighed by the way of the
/// rig; a rig at rest learns nothing of them.
///
/// Near the rig: size and dip show an anomaly without a heading. Its part across the Earth's field turns the
/// heading, is as large as the others, and is not seen. So a deviation that was seen counts for some metres,
/// also where size and dip fit again by chance:
///   a = max(|d| / sqrt 2 where d (T, of size and dip) is significant, a exp(-way / kLength_m)).
///
/// In the field in force: the first field may be that of iron nearby. Its anomaly b is kStart_T at first. It
/// decreases as a does, increases to a deviation in any direction, and the way of agreement confirms it:
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

  /// One sigma of an axis of the anomalous field at the last place, T; zero where none was seen.
  double sigma_T() const { return near_T_; }

  /// One sigma of an axis of the anomaly in the field in force, T.
  double fieldSigma_T() const;

  /// Another field is in force; nothing has confirmed it yet.
  void restartAgreement() { agreed_m_ = 0.0; }

 private:
  double near_T_ = 0.0;
  double in_force_T_ = kStart_T;
  double agreed_m_ = 0.0;
  std::optional<Vec3> anchor_W_;  ///< place up to which the way was counted
};

}  // namespace lodeline

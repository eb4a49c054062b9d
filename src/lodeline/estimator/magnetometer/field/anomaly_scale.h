#pragma once

#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Size of the anomalous field (iron, magnetic rock, steel) that may be present at the rig. Only size and dip
/// show an anomaly without a heading. Its part across the Earth's field turns the heading, is as large as the
/// others, and is not seen. So a deviation that was seen counts for a while, also where size and dip fit again
/// by chance:
///   a = max(|d| / sqrt 2 where d is significant, a exp(-way / kLength_m)),
/// with d the deviation of size and dip (T) and the way of the rig, because anomalies of iron and rock change
/// over metres. A rig at rest learns nothing of them. At the start, a is `kStart_T`: the first field may be
/// that of iron nearby.
class AnomalyScale {
 public:
  static constexpr double kStart_T = 2.5e-6;
  static constexpr double kMost_T = 10e-6;
  static constexpr double kLength_m = 2.0;
  /// Way of agreement over which the field in force is confirmed as the Earth's by a factor of e.
  static constexpr double kConfirmed_m = 4.0;

  /// Adds a reading at a place. `deviation_T`: of size and dip, as a mean with `variance_T2` for each of the
  /// two; `agrees`: whether the gate accepted the field as the Earth's.
  void add(const Vec3& position_W, const Vec2& deviation_T, double variance_T2, bool agrees);

  /// One sigma of an axis of the anomalous field at the last place, T.
  double sigma_T() const { return sigma_T_; }

  /// One sigma of the anomaly that the field in force may contain for good, T: a, less what the way of
  /// agreement rules out.
  double fieldSigma_T() const;

  /// Another field is in force; nothing has confirmed it yet.
  void restartAgreement() { agreed_m_ = 0.0; }

 private:
  double sigma_T_ = kStart_T;
  double agreed_m_ = 0.0;
  std::optional<Vec3> anchor_W_;  ///< place up to which the way was counted
};

}  // namespace lodeline

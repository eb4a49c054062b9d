#pragma once

#include <optional>

#include "lodeline/ahrs/low_pass.h"
#include "lodeline/geometry/types.h"

namespace lodeline {

/// Strength and dip of a magnetic field.
struct FieldShape {
  double norm_T = 0.0;
  double dip_rad = 0.0;  ///< below the horizon

  static FieldShape of(const Vec3& field_W);
  double horizontal_T() const;
};

struct FieldGateOptions {
  double norm_tolerance = 0.06;     ///< of the reference
  double dip_tolerance_rad = 0.10;  ///< 6 deg
  double smoothing_s = 0.1;         ///< of the field that is judged
  double undisturbed_s = 0.3;       ///< within the tolerances for so long before the field is trusted
  double reference_time_constant_s = 20.0;
  double first_reference_s = 2.0;  ///< the first reference is a mean over this time
  /// A different field is taken for the new reference when it held through so much turning of the body: a
  /// magnet that moves along, or one that is near, changes strength or dip with attitude and place.
  double new_reference_turn_rad = 6.0;
  double new_reference_s = 20.0;
};

enum class FieldVerdict {
  None,      ///< no reading yet
  Settling,  ///< the reference is being formed, or a disturbance has just ended
  Good,
  WrongNorm,
  WrongDip,
};
const char* toString(FieldVerdict verdict);

/// Judges whether the measured field is the Earth's, by its strength and dip against a reference: the site's
/// where known, else what was measured first. The reference follows slowly while the field is good. After
/// Laidig & Seel ("VQF", Information Fusion 2023, section 3.7).
class FieldGate {
 public:
  FieldGate(const FieldGateOptions& options, const std::optional<FieldShape>& site);

  /// `field_W`: in a frame with z up and any heading; `turned_rad`: by which the body turned in `step_s`.
  FieldVerdict update(const Vec3& field_W, double turned_rad, double step_s);

  /// Of the last field, relative to its strength: the part that strength and dip show to be wrong.
  double disturbance() const { return disturbance_; }
  const std::optional<FieldShape>& reference() const { return reference_; }
  const FieldShape& field() const { return field_; }

 private:
  bool matches(const FieldShape& reference) const;
  void learn(FieldShape* reference, double gain) const;
  void considerNewReference(double turned_rad, double step_s);

  FieldGateOptions options_;
  LowPass<Vec3> smoothed_W_;
  FieldShape field_;
  std::optional<FieldShape> reference_;
  bool is_site_ = false;
  double learned_s_ = 0.0;
  double good_s_ = 0.0;
  double disturbance_ = 0.0;
  std::optional<FieldShape> candidate_;
  double candidate_s_ = 0.0, candidate_turn_rad_ = 0.0;
};

}  // namespace lodeline

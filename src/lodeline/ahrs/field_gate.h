#pragma once

#include <optional>

#include "lodeline/ahrs/low_pass.h"
#include "lodeline/types.h"

namespace lodeline {

/// Magnitude and dip of a magnetic field.
struct FieldShape {
  double norm_T = 0.0;
  double dip_rad = 0.0;  ///< below the horizon

  static FieldShape of(const Vec3& field_W);
  double horizontal_T() const;
};

struct FieldGateOptions {
  double norm_tolerance = 0.06;     ///< relative to the reference
  double dip_tolerance_rad = 0.10;  ///< 6 deg
  double smoothing_s = 0.1;         ///< low-pass time constant of the tested field
  double undisturbed_s = 0.3;       ///< time within the tolerances before the field is accepted
  double reference_time_constant_s = 20.0;
  double first_reference_s = 2.0;  ///< averaging time of the first reference
  /// Rotation and time that a different field must persist through to become the new reference. The field of
  /// a magnet on the rig or nearby changes its magnitude or dip with attitude and position.
  double new_reference_turn_rad = 6.0;
  double new_reference_s = 20.0;
};

enum class FieldVerdict {
  None,      ///< no reading yet
  Settling,  ///< the reference is being measured, or a disturbance has just ended
  Good,
  WrongNorm,
  WrongDip,
};
const char* toString(FieldVerdict verdict);

/// Tests whether the measured field is the Earth's by comparing magnitude and dip with a reference. The
/// reference is the field at the site where known, otherwise the first measured field. A measured reference
/// follows the field slowly while it is accepted. After Laidig & Seel ("VQF", Information Fusion 2023,
/// section 3.7).
class FieldGate {
 public:
  FieldGate(const FieldGateOptions& options, const std::optional<FieldShape>& site);

  /// `field_W`: in a frame with z up and arbitrary heading; `turned_rad`: rotation of the body in `step_s`.
  FieldVerdict update(const Vec3& field_W, double turned_rad, double step_s);

  /// Relative error of the last field that magnitude and dip show.
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

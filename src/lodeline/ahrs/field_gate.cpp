#include "lodeline/ahrs/field_gate.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

FieldShape FieldShape::of(const Vec3& field_W) {
  return {field_W.norm(), std::atan2(-field_W.z(), field_W.head<2>().norm())};
}

double FieldShape::horizontal_T() const { return norm_T * std::cos(dip_rad); }

const char* toString(FieldVerdict verdict) {
  switch (verdict) {
    case FieldVerdict::None:
      return "none";
    case FieldVerdict::Settling:
      return "settling";
    case FieldVerdict::Good:
      return "good";
    case FieldVerdict::WrongNorm:
      return "wrong_norm";
    case FieldVerdict::WrongDip:
      return "wrong_dip";
  }
  return "";
}

FieldGate::FieldGate(const FieldGateOptions& options, const std::optional<FieldShape>& site)
    : options_(options), smoothed_W_(options.smoothing_s), reference_(site), is_site_(site.has_value()) {
  if (is_site_) learned_s_ = options.first_reference_s;
}

bool FieldGate::matches(const FieldShape& reference) const {
  return std::abs(field_.norm_T - reference.norm_T) <= options_.norm_tolerance * reference.norm_T &&
         std::abs(field_.dip_rad - reference.dip_rad) <= options_.dip_tolerance_rad;
}

void FieldGate::learn(FieldShape* reference, double gain) const {
  reference->norm_T += gain * (field_.norm_T - reference->norm_T);
  reference->dip_rad += gain * (field_.dip_rad - reference->dip_rad);
}

FieldVerdict FieldGate::update(const Vec3& field_W, double turned_rad, double step_s) {
  field_ = FieldShape::of(smoothed_W_.update(field_W, step_s));
  if (!reference_) reference_ = field_;
  if (learned_s_ < options_.first_reference_s) {
    learned_s_ += step_s;
    learn(&*reference_, std::min(1.0, step_s / learned_s_));
    return FieldVerdict::Settling;
  }
  const double norm_error = field_.norm_T / reference_->norm_T - 1.0;
  const double dip_error = field_.dip_rad - reference_->dip_rad;
  disturbance_ = std::hypot(norm_error, dip_error);
  if (matches(*reference_)) {
    candidate_.reset();
    good_s_ += step_s;
    if (good_s_ < options_.undisturbed_s) return FieldVerdict::Settling;
    if (!is_site_) learn(&*reference_, std::min(1.0, step_s / options_.reference_time_constant_s));
    return FieldVerdict::Good;
  }
  good_s_ = 0.0;
  if (!is_site_) considerNewReference(turned_rad, step_s);
  return std::abs(norm_error) > options_.norm_tolerance ? FieldVerdict::WrongNorm : FieldVerdict::WrongDip;
}

void FieldGate::considerNewReference(double turned_rad, double step_s) {
  if (!candidate_ || !matches(*candidate_)) {
    candidate_ = field_;
    candidate_s_ = candidate_turn_rad_ = 0.0;
    return;
  }
  learn(&*candidate_, std::min(1.0, step_s / options_.reference_time_constant_s));
  candidate_s_ += step_s;
  candidate_turn_rad_ += turned_rad;
  if (candidate_s_ < options_.new_reference_s || candidate_turn_rad_ < options_.new_reference_turn_rad)
    return;
  reference_ = candidate_;
  candidate_.reset();
}

}  // namespace lodeline

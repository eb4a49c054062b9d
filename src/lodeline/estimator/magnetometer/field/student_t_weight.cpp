#include "lodeline/estimator/magnetometer/field/student_t_weight.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

void StudentTWeight::add(Time time, const Vec2& deviation_T, double state_variance_T2,
                         double white_variance_T2) {
  const double gain = last_ ? 1.0 - std::exp(-(time - *last_).seconds() / options_.deviation_s) : 1.0;
  last_ = time;
  mean_T_ += gain * (deviation_T - mean_T_);
  white_variance_T2_ = (1.0 - gain) * (1.0 - gain) * white_variance_T2_ + gain * gain * white_variance_T2;
  state_variance_T2_ = state_variance_T2;
  excess_T2_ = std::max(0.0, mean_T_.squaredNorm() - 2.0 * (white_variance_T2_ + state_variance_T2));
}

double StudentTWeight::sigma_T(double correlated_noise_sigma_T) const {
  const double freedom = options_.student_dof;
  return std::max(correlated_noise_sigma_T,
                  std::sqrt((freedom * correlated_noise_sigma_T * correlated_noise_sigma_T + excess_T2_) /
                            (freedom + 2.0)));
}

}  // namespace lodeline

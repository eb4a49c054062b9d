#include "lodeline/estimator/field_floor.h"

#include <cmath>

namespace lodeline {

void FieldFloor::add(Time time, double along_T, double dip_T, double state_variance_T2,
                     double white_variance_T2) {
  if (mean_ && (time - mean_->begin).seconds() >= options_.floor_correlation_s) learn();
  if (!mean_) mean_ = Mean{time};
  ++mean_->readings;
  mean_->along_T += along_T;
  mean_->dip_T += dip_T;
  mean_->white_variance_T2 += white_variance_T2;
  mean_->state_variance_T2 = state_variance_T2;
}

void FieldFloor::learn() {
  const double n = mean_->readings;
  const double variance_T2 = mean_->state_variance_T2 + mean_->white_variance_T2 / (n * n);
  const double floor_T2 = sigma_T_ * sigma_T_;
  const double gain = floor_T2 / (floor_T2 + variance_T2);
  const auto expectedSquare = [&](double sum_T) {
    return std::pow(gain * sum_T / n, 2) + (1.0 - gain) * floor_T2;
  };
  const double kept = std::exp(-options_.floor_correlation_s / options_.floor_memory_s);
  squares_T2_ = kept * squares_T2_ + expectedSquare(mean_->along_T) + expectedSquare(mean_->dip_T);
  components_ = kept * components_ + 2.0;
  const double prior = options_.floor_prior_samples;
  sigma_T_ = std::sqrt((prior * options_.floor_T * options_.floor_T + squares_T2_) / (prior + components_));
  mean_.reset();
}

}  // namespace lodeline

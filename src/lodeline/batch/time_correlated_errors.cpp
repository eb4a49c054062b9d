#include "lodeline/batch/time_correlated_errors.h"

#include <algorithm>

namespace lodeline {

void TimeCorrelatedErrors::add(const std::vector<Vec2>& errors) {
  constexpr size_t kFewest = 6;  // with fewer, too little is left after the landmark's estimation
  const auto n = static_cast<double>(errors.size());
  observations_ += n;
  squared_lengths_ += n * n;
  for (const Vec2& error : errors) squares_ += error.squaredNorm();
  if (errors.size() < kFewest) return;
  double squares = errors.front().squaredNorm(), products = 0.0;
  for (size_t i = 1; i < errors.size(); ++i) {
    squares += errors[i].squaredNorm();
    products += errors[i].dot(errors[i - 1]);
  }
  if (!(squares > 0.0)) return;
  likeness_ += n * (products / (n - 1.0)) / (squares / n);
  of_white_noise_ += n * (-0.7 / n);
  of_random_walk_ += n * (1.0 - 5.8 / n);
}

double TimeCorrelatedErrors::designEffect() const {
  if (!(of_random_walk_ > of_white_noise_)) return 1.0;
  const double share = (likeness_ - of_white_noise_) / (of_random_walk_ - of_white_noise_);
  return 1.0 + (squared_lengths_ / observations_ - 1.0) * std::clamp(share, 0.0, 1.0);
}

double TimeCorrelatedErrors::variance() const {
  return observations_ > 0.0 ? std::max(1.0, designEffect() * squares_ / (2.0 * observations_)) : 1.0;
}

}  // namespace lodeline

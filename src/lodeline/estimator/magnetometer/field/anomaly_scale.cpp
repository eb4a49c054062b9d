#include "lodeline/estimator/magnetometer/field/anomaly_scale.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kStride_m = 0.1;  // shorter ways may be errors of the positions
/// Squared deviation over the variance of one of its two components that noise exceeds once in 400.
constexpr double kSignificant = 12.0;

}  // namespace

void AnomalyScale::add(const Vec3& position_W, const Vec2& deviation_T, double variance_T2, bool agrees) {
  if (!anchor_W_) anchor_W_ = position_W;
  const double way_m = (position_W - *anchor_W_).norm();
  if (way_m >= kStride_m) {
    anchor_W_ = position_W;
    sigma_T_ *= std::exp(-way_m / kLength_m);
    if (agrees) agreed_m_ += way_m;
  }
  const double square_T2 = deviation_T.squaredNorm();
  if (square_T2 > kSignificant * variance_T2) sigma_T_ = std::max(sigma_T_, std::sqrt(0.5 * square_T2));
  sigma_T_ = std::min(sigma_T_, kMost_T);
}

double AnomalyScale::fieldSigma_T() const { return sigma_T_ * std::exp(-agreed_m_ / kConfirmed_m); }

}  // namespace lodeline

#include "lodeline/estimator/magnetometer/field/anomaly_scale.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kStride_m = 0.1;  // shorter ways may be errors of the positions
/// Squared deviation of size and dip over the variance of one of the two. Noise exceeds it once in 400.
constexpr double kSignificant = 12.0;

}  // namespace

void AnomalyScale::add(const Vec3& position_W, const Deviation& deviation, bool agrees) {
  if (!anchor_W_) anchor_W_ = position_W;
  const double way_m = (position_W - *anchor_W_).norm();
  if (way_m >= kStride_m) {
    anchor_W_ = position_W;
    in_force_T_ *= std::exp(-way_m / kLength_m);
    if (agrees) agreed_m_ += way_m;
  }
  const double square_T2 = deviation.size_and_dip_T.squaredNorm();
  if (square_T2 > kSignificant * deviation.variance_T2)
    in_force_T_ = std::max(in_force_T_, std::sqrt(0.5 * square_T2));
  if (!agrees) in_force_T_ = std::max(in_force_T_, std::sqrt(0.5) * std::abs(deviation.across_T));
  in_force_T_ = std::min(in_force_T_, kMost_T);
}

double AnomalyScale::sigma_T() const { return in_force_T_ * std::exp(-agreed_m_ / kConfirmed_m); }

}  // namespace lodeline

#pragma once

#include <Eigen/Cholesky>
#include <memory>

#include "lodeline/magnetometer/field_map/potential_basis.h"
#include "lodeline/types.h"

namespace lodeline {

/// A field, T, with its covariance, T^2, and its derivative with respect to the place, T/m.
struct PredictedField {
  Vec3 field = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();
  Mat3 by_place = Mat3::Zero();
};

/// One box of a map of a magnetic anomaly: the posterior of the basis functions' weights in information form.
/// Readings add up, so their order does not matter. The size never changes with their number.
class FieldMapTile {
 public:
  /// `basis` must outlive it.
  FieldMapTile(const PotentialBasis& basis, const Vec3& centre);

  const Vec3& centre() const { return centre_; }

  /// Adds an anomaly (T) that was measured at a place, with the covariance of its independent error.
  void add(const Vec3& place, const Vec3& anomaly, const Mat3& covariance);

  /// The anomaly at a place; without readings near it, zero with the covariance of the prior.
  PredictedField predict(const Vec3& place) const;

 private:
  struct Solution {
    Eigen::LLT<Eigen::MatrixXd> information;
    Eigen::VectorXd weights;
  };
  const Solution& solution() const;

  const PotentialBasis* basis_;
  Vec3 centre_;
  Eigen::MatrixXd information_;  ///< lower triangle
  Eigen::VectorXd weighted_sum_;
  mutable std::unique_ptr<Solution> solution_;  ///< null after a new reading
};

}  // namespace lodeline

#include "lodeline/magnetometer/field_map/field_map_tile.h"

namespace lodeline {

FieldMapTile::FieldMapTile(const PotentialBasis& basis, const Vec3& centre)
    : basis_(&basis), centre_(centre), weighted_sum_(Eigen::VectorXd::Zero(basis.size())) {
  information_ = basis.weightVariances().cwiseInverse().asDiagonal();
}

void FieldMapTile::add(const Vec3& place, const Vec3& anomaly, const Mat3& covariance) {
  const PotentialBasis::Gradients by_weights = basis_->gradients(place - centre_);
  const Eigen::LLT<Mat3> noise(covariance);
  const PotentialBasis::Gradients whitened = noise.matrixL().solve(by_weights);
  information_.selfadjointView<Eigen::Lower>().rankUpdate(whitened.transpose());
  weighted_sum_ += whitened.transpose() * noise.matrixL().solve(anomaly);
  solution_.reset();
}

const FieldMapTile::Solution& FieldMapTile::solution() const {
  if (!solution_) {
    solution_ = std::make_unique<Solution>();
    solution_->information.compute(information_.selfadjointView<Eigen::Lower>());
    solution_->weights = solution_->information.solve(weighted_sum_);
  }
  return *solution_;
}

PredictedField FieldMapTile::predict(const Vec3& place) const {
  const Solution& known = solution();
  const PotentialBasis::Gradients by_weights = basis_->gradients(place - centre_);
  const Eigen::MatrixXd root = known.information.matrixL().solve(by_weights.transpose());
  PredictedField predicted;
  predicted.field = by_weights * known.weights;
  predicted.covariance = root.transpose() * root;
  predicted.by_place = basis_->fieldByPoint(place - centre_, known.weights);
  return predicted;
}

}  // namespace lodeline

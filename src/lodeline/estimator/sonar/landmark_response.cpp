#include "lodeline/estimator/sonar/landmark_response.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/problem/normal_equations.h"

namespace lodeline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

int tangentSize(int ambient_size) { return ambient_size == kPoseSize ? kPoseTangentSize : ambient_size; }

}  // namespace

LandmarkResponse responseOf(const LandmarkFactors& terms) {
  LandmarkResponse response;
  response.landmark = terms.landmark;
  Mat3 hessian = Mat3::Zero();
  for (const Factor& factor : terms.factors) {
    const std::vector<int>& sizes = factor.function->parameter_block_sizes();
    std::vector<RowMajor> jacobians;
    std::vector<double*> pointers;
    for (const int size : sizes) jacobians.emplace_back(factor.function->num_residuals(), size);
    for (RowMajor& jacobian : jacobians) pointers.push_back(jacobian.data());
    Eigen::VectorXd residual(factor.function->num_residuals());
    factor.function->Evaluate(factor.blocks.data(), residual.data(), pointers.data());
    double rho[3] = {0.0, 1.0, 0.0};
    if (factor.loss) factor.loss->Evaluate(residual.squaredNorm(), rho);
    const auto own = std::find(factor.blocks.begin(), factor.blocks.end(), terms.landmark);
    const RowMajor& by_landmark = jacobians[static_cast<size_t>(own - factor.blocks.begin())];
    hessian += rho[1] * by_landmark.transpose() * by_landmark;
    for (size_t i = 0; i < sizes.size(); ++i) {
      if (factor.blocks[i] == terms.landmark) continue;
      const int size = tangentSize(sizes[i]);
      auto gain = std::find_if(response.gains.begin(), response.gains.end(),
                               [&](const auto& other) { return other.block == factor.blocks[i]; });
      if (gain == response.gains.end()) {
        response.gains.push_back({factor.blocks[i], sizes[i], Eigen::MatrixXd::Zero(3, size)});
        gain = std::prev(response.gains.end());
      }
      gain->by_block += rho[1] * by_landmark.transpose() * jacobians[i].leftCols(size);
    }
  }
  const Mat3 root = landmarkInverseRoot(hessian);
  response.covariance = root * root.transpose();
  for (LandmarkResponse::Gain& gain : response.gains) gain.by_block = -response.covariance * gain.by_block;
  return response;
}

EliminatedLandmarksFactor::EliminatedLandmarksFactor(Factor factor, std::vector<LandmarkResponse> responses,
                                                     double share)
    : factor_(std::move(factor)), responses_(std::move(responses)) {
  set_num_residuals(1);
  const std::vector<int>& sizes = factor_.function->parameter_block_sizes();
  for (size_t i = 0; i < sizes.size(); ++i) {
    const auto response = std::find_if(responses_.begin(), responses_.end(), [&](const auto& other) {
      return other.landmark == factor_.blocks[i];
    });
    const bool is_landmark = response != responses_.end();
    response_of_.push_back(is_landmark ? &*response : nullptr);
    index_of_.push_back(is_landmark ? 0 : indexOf(factor_.blocks[i], sizes[i]));
  }
  for (const LandmarkResponse& response : responses_) {
    for (const LandmarkResponse::Gain& gain : response.gains) indexOf(gain.block, gain.ambient_size);
  }
  std::vector<RowMajor> derivatives;
  evaluate(blocks_.data(), &derivatives);
  double variance = 1.0;
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (response_of_[i])
      variance += share * (derivatives[i] * response_of_[i]->covariance * derivatives[i].transpose()).value();
  }
  scale_ = std::sqrt(variance);
}

size_t EliminatedLandmarksFactor::indexOf(double* block, int size) {
  const auto found = std::find(blocks_.begin(), blocks_.end(), block);
  if (found != blocks_.end()) return static_cast<size_t>(found - blocks_.begin());
  blocks_.push_back(block);
  mutable_parameter_block_sizes()->push_back(size);
  return blocks_.size() - 1;
}

double EliminatedLandmarksFactor::evaluate(double const* const* parameters,
                                           std::vector<RowMajor>* derivatives) const {
  const std::vector<int>& sizes = factor_.function->parameter_block_sizes();
  std::vector<const double*> values;
  for (size_t i = 0; i < sizes.size(); ++i)
    values.push_back(response_of_[i] ? response_of_[i]->landmark : parameters[index_of_[i]]);
  double residual = 0.0;
  if (!derivatives) {
    factor_.function->Evaluate(values.data(), &residual, nullptr);
    return residual;
  }
  std::vector<double*> rows;
  for (const int size : sizes) derivatives->emplace_back(1, size);
  for (RowMajor& derivative : *derivatives) rows.push_back(derivative.data());
  factor_.function->Evaluate(values.data(), &residual, rows.data());
  return residual;
}

bool EliminatedLandmarksFactor::Evaluate(double const* const* parameters, double* residuals,
                                         double** jacobians) const {
  std::vector<RowMajor> derivatives;
  residuals[0] = evaluate(parameters, jacobians ? &derivatives : nullptr) / scale_;
  if (!jacobians) return true;
  const std::vector<int>& sizes = parameter_block_sizes();
  for (size_t i = 0; i < sizes.size(); ++i) {
    if (jacobians[i]) std::fill_n(jacobians[i], sizes[i], 0.0);
  }
  const auto add = [&](size_t block, const Eigen::RowVectorXd& row) {
    if (jacobians[block]) Eigen::Map<Eigen::RowVectorXd>(jacobians[block], row.size()) += row / scale_;
  };
  for (size_t i = 0; i < derivatives.size(); ++i) {
    if (!response_of_[i]) {
      add(index_of_[i], derivatives[i]);
      continue;
    }
    for (const LandmarkResponse::Gain& gain : response_of_[i]->gains) {
      const auto block = std::find(blocks_.begin(), blocks_.end(), gain.block);
      add(static_cast<size_t>(block - blocks_.begin()), derivatives[i] * gain.by_block);
    }
  }
  return true;
}

}  // namespace lodeline

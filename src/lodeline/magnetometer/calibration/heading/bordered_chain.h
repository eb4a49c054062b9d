#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Gauss-Newton normal equations for a chain of small states x_0 … x_n and a few parameters p. Residuals
/// connect each state with the next one and with p. Eliminating one state after the other (forward sweep,
/// then back substitution) is the batch form of a Kalman filter with Rauch-Tung-Striebel smoothing. The
/// remaining equations are those of the parameters with the states marginalized.
template <int kParameters>
class BorderedChain {
 public:
  using Parameters = Eigen::Matrix<double, kParameters, 1>;
  using Information = Eigen::Matrix<double, kParameters, kParameters>;
  using Border = Eigen::Matrix<double, 3, kParameters>;

  explicit BorderedChain(size_t states) : states_(states) {}

  /// Adds the whitened residual r + by_state x_k + by_parameters p.
  void addUnary(size_t k, const Vec3& r, const Mat3& by_state, const Border& by_parameters) {
    State& s = states_[k];
    s.diagonal.noalias() += by_state.transpose() * by_state;
    s.border.noalias() += by_state.transpose() * by_parameters;
    s.gradient.noalias() += by_state.transpose() * r;
    addParameters(r, by_parameters);
  }

  /// Adds the whitened residual r + by_first x_k + by_second x_{k+1} + by_parameters p.
  void addBinary(size_t k, const Vec3& r, const Mat3& by_first, const Mat3& by_second,
                 const Border& by_parameters) {
    addUnary(k, r, by_first, by_parameters);
    State& next = states_[k + 1];
    next.diagonal.noalias() += by_second.transpose() * by_second;
    next.border.noalias() += by_second.transpose() * by_parameters;
    next.gradient.noalias() += by_second.transpose() * r;
    states_[k].coupling.noalias() += by_first.transpose() * by_second;
  }

  /// Adds the whitened scalar residual (value + p[index]) / sigma.
  void addPrior(int index, double value, double sigma) {
    information_(index, index) += 1.0 / (sigma * sigma);
    gradient_[index] += value / (sigma * sigma);
    cost_ += 0.5 * value * value / (sigma * sigma);
  }

  /// Half the sum of squares of all added residuals.
  double cost() const { return cost_; }

  struct Marginal {
    Information information;  ///< information matrix of the parameters
    Parameters gradient;
    double log_determinant = 0.0;  ///< log determinant of the states' block
    double reduction = 0.0;        ///< decrease of the cost by the optimal step of the states for p = 0
  };
  /// Marginalizes the states; call it only once.
  Marginal eliminate() {
    Marginal marginal{information_, gradient_, 0.0, 0.0};
    for (size_t k = 0; k < states_.size(); ++k) {
      State& s = states_[k];
      s.inverse = s.diagonal.inverse();
      marginal.log_determinant += std::log(s.diagonal.determinant());
      const Border scaled = s.inverse * s.border;
      const Vec3 step = s.inverse * s.gradient;
      marginal.information.noalias() -= s.border.transpose() * scaled;
      marginal.gradient.noalias() -= s.border.transpose() * step;
      marginal.reduction += 0.5 * s.gradient.dot(step);
      if (k + 1 == states_.size()) break;
      State& next = states_[k + 1];
      next.diagonal.noalias() -= s.coupling.transpose() * s.inverse * s.coupling;
      next.border.noalias() -= s.coupling.transpose() * scaled;
      next.gradient.noalias() -= s.coupling.transpose() * step;
    }
    return marginal;
  }

  /// Steps of the states for a step p of the parameters; call it after eliminate().
  std::vector<Vec3> statesFor(const Parameters& p) const {
    std::vector<Vec3> steps(states_.size());
    Vec3 following = Vec3::Zero();
    for (size_t k = states_.size(); k-- > 0;) {
      const State& s = states_[k];
      following = -(s.inverse * (s.gradient + s.border * p + s.coupling * following));
      steps[k] = following;
    }
    return steps;
  }

 private:
  struct State {
    Mat3 diagonal = Mat3::Zero();
    Mat3 coupling = Mat3::Zero();  ///< block with the next state
    Border border = Border::Zero();
    Vec3 gradient = Vec3::Zero();
    Mat3 inverse = Mat3::Zero();
  };

  void addParameters(const Vec3& r, const Border& by_parameters) {
    information_.noalias() += by_parameters.transpose() * by_parameters;
    gradient_.noalias() += by_parameters.transpose() * r;
    cost_ += 0.5 * r.squaredNorm();
  }

  std::vector<State> states_;
  Information information_ = Information::Zero();
  Parameters gradient_ = Parameters::Zero();
  double cost_ = 0.0;
};

}  // namespace lodeline

#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <memory>
#include <vector>

namespace lodeline {

/// One term of the cost: a function, its blocks in order, and a robust loss (null for none).
struct Factor {
  std::unique_ptr<ceres::CostFunction> function;
  std::shared_ptr<const ceres::LossFunction> loss;
  std::vector<double*> blocks;
};

/// Cost of a factor at its blocks' values; `residual` is a work buffer.
double costOf(const Factor& factor, std::vector<double>& residual);

/// The terms that contain one landmark.
struct LandmarkFactors {
  double* landmark = nullptr;
  std::vector<Factor> factors;
};

}  // namespace lodeline

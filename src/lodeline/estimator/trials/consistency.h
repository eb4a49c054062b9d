#pragma once

#include <vector>

#include "lodeline/estimator/trials/scene.h"

namespace lodeline {

/// Normalized estimation errors squared (NEES), e^T P^-1 e, of one estimate; they show whether the errors
/// match the covariance. The mean NEES of a consistent estimator is the number of coordinates in e
/// (Bar-Shalom, Li & Kirubarajan, "Estimation with applications to tracking and navigation", 2001, section
/// 5.4).
struct NeesSample {
  double pose = 0.0;                                      ///< 6 coordinates
  double position = 0.0;                                  ///< 3
  double orientation = 0.0;                               ///< 3
  double yaw = 0.0;                                       ///< 1, about the world's vertical
  double motion = 0.0;                                    ///< velocity and both biases, 9
  double velocity = 0.0;                                  ///< 3
  double gyroscope_bias = 0.0;                            ///< 3
  double accelerometer_bias = 0.0;                        ///< 3
  double position_error_m = 0.0, position_sigma_m = 0.0;  ///< norm of the error; root of the trace
  double yaw_error_rad = 0.0, yaw_sigma_rad = 0.0;
};

NeesSample neesOf(const Comparison& comparison);

/// Samples at one time over all seeds.
struct ConsistencyRow {
  double time_s = 0.0;
  std::vector<NeesSample> samples;

  double mean(double NeesSample::*figure) const;
  double rootMeanSquare(double NeesSample::*figure) const;
};

struct ConsistencyOptions {
  TestSceneOptions scene;      ///< its seed and duration are filled in
  EstimatorOptions estimator;  ///< see honestOptions()
  int seeds = 20;
  std::vector<double> times_s = {5.0, 20.0, 60.0};  ///< from the start of the motion, ascending
};

struct Consistency {
  std::vector<ConsistencyRow> rows;
  int lost = 0;  ///< number of seeds without an estimate at one of the times
};

/// Runs the scene once per seed.
Consistency measureConsistency(const ConsistencyOptions& options);

/// Quantiles of the normal distribution: a two-sided band with probability 0.999 or 0.95.
constexpr double kBand999 = 3.2905;
constexpr double kBand95 = 1.9600;

/// Bounds of the mean of `count` independent NEES samples of a consistent estimator. They hold with the
/// probability that belongs to `quantile`, by Wilson & Hilferty's approximation of the chi-squared
/// distribution.
struct NeesBounds {
  double low, high;
};
NeesBounds neesBounds(int coordinates, int count, double quantile = kBand999);

}  // namespace lodeline

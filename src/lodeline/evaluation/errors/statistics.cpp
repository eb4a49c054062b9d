#include "lodeline/trajectory.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

double quantile(const std::vector<double>& sorted_values, double fraction) {
  const double position = fraction * static_cast<double>(sorted_values.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted_values.size() - 1);
  const double weight = position - static_cast<double>(below);
  return sorted_values[below] + weight * (sorted_values[above] - sorted_values[below]);
}

Statistics computeStatistics(const std::vector<double>& values) {
  Statistics result;
  result.count = values.size();
  if (values.empty()) return result;
  const double n = static_cast<double>(values.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  result.mean = sum / n;
  result.rmse = std::sqrt(sum_of_squares / n);
  double squared_deviation = 0.0;
  for (const double value : values) squared_deviation += (value - result.mean) * (value - result.mean);
  result.std = std::sqrt(squared_deviation / n);

  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  result.min = sorted.front();
  result.lower_quartile = quantile(sorted, 0.25);
  result.median = quantile(sorted, 0.5);
  result.upper_quartile = quantile(sorted, 0.75);
  result.max = sorted.back();
  return result;
}

}  // namespace lodeline

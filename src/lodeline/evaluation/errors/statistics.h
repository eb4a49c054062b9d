#pragma once

#include <cstddef>
#include <vector>

namespace lodeline {

/// Summary of a set of error values, in their unit. All zero for an empty set.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double std = 0.0;  ///< root mean squared deviation from the mean (divisor: count)
  double min = 0.0;
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double max = 0.0;
};

Statistics computeStatistics(const std::vector<double>& values);

/// Quantile: value below which the share `fraction` (0 to 1) of the sorted values lies, interpolated linearly
/// between neighbours. The values must be sorted and not empty.
double quantile(const std::vector<double>& sorted_values, double fraction);

}  // namespace lodeline

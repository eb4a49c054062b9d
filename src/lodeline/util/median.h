#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace lodeline {

/// The element of rank floor(share n) of n values in ascending order, at most the largest. `share`: 0 to 1.
/// Zero of no values.
template <typename Value>
Value orderStatistic(std::vector<Value> values, double share) {
  if (values.empty()) return Value();
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(std::min(rank, values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The upper median; zero of no values.
template <typename Value>
Value median(std::vector<Value> values) {
  return orderStatistic(std::move(values), 0.5);
}

/// Median time from a sample to the next, s; zero of fewer than two samples.
template <typename Samples>
double medianStep_s(const Samples& samples) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < samples.size(); ++i)
    steps_s.push_back((samples[i].time - samples[i - 1].time).seconds());
  return median(std::move(steps_s));
}

}  // namespace lodeline

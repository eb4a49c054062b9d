#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace lodeline {

/// A smooth random function with unit RMS and zero mean: six sine waves of different wavelengths and random
/// phases. Longer waves have larger amplitudes.
class Waves {
 public:
  /// Wavelengths are between `shortest` and `longest`, in the unit of the argument.
  Waves(uint64_t seed, std::string_view stream, double shortest, double longest);

  double operator()(double x) const;
  double derivative(double x) const;

 private:
  static constexpr int kCount = 6;
  std::array<double, kCount> wave_number_;
  std::array<double, kCount> phase_;
  std::array<double, kCount> amplitude_;
};

}  // namespace lodeline

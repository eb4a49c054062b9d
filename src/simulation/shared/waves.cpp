#include "simulation/shared/waves.h"

#include <cmath>
#include <numbers>

#include "simulation/shared/random.h"

namespace lodeline {

Waves::Waves(uint64_t seed, std::string_view stream, double shortest, double longest) {
  Random random(seed, stream);
  double power = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double wavelength = shortest * std::pow(longest / shortest, (i + random.uniform()) / kCount);
    wave_number_[i] = 2.0 * std::numbers::pi / wavelength;
    phase_[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
    amplitude_[i] = std::sqrt(wavelength);
    power += 0.5 * amplitude_[i] * amplitude_[i];
  }
  for (double& amplitude : amplitude_) amplitude /= std::sqrt(power);
}

double Waves::operator()(double x) const {
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) sum += amplitude_[i] * std::sin(wave_number_[i] * x + phase_[i]);
  return sum;
}

double Waves::derivative(double x) const {
  double sum = 0.0;
  for (int i = 0; i < kCount; ++i) {
    sum += amplitude_[i] * wave_number_[i] * std::cos(wave_number_[i] * x + phase_[i]);
  }
  return sum;
}

}  // namespace lodeline

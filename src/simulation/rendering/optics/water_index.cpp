#include "simulation/rendering/optics/water_index.h"

namespace lodeline {

double waterIndexAt(double salinity_g_per_kg, double temperature_C, double wavelength_nm) {
  const double s = salinity_g_per_kg, t = temperature_C, l = wavelength_nm;
  return 1.31405 + (1.779e-4 - 1.05e-6 * t + 1.6e-8 * t * t) * s - 2.02e-6 * t * t +
         (15.868 + 0.01155 * s - 0.00423 * t) / l - 4382.0 / (l * l) + 1.1455e6 / (l * l * l);
}

double acrylicDispersion(double wavelength_nm) {
  // Cauchy's equation with 0.0046 um^2.
  const auto inverseSquare = [](double nm) { return 1e6 / (nm * nm); };
  return 0.0046 * (inverseSquare(wavelength_nm) - inverseSquare(kMiddleWavelength_nm));
}

double waterDensity_kg_per_m3(double salinity_g_per_kg) { return 997.0 + 0.755 * salinity_g_per_kg; }

}  // namespace lodeline

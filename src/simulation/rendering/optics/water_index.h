#pragma once

namespace lodeline {

/// Wavelength of the refractive indices of a calibration, nm: the middle of a grey camera's band.
inline constexpr double kMiddleWavelength_nm = 550.0;

/// Refractive index of water relative to air: the empirical equation of X. Quan and E. Fry, "Empirical
/// equation for the index of refraction of seawater", Applied Optics 34, 1995. Salinity in g/kg (0..35).
double waterIndexAt(double salinity_g_per_kg, double temperature_C, double wavelength_nm);

/// Refractive index of acrylic minus that at kMiddleWavelength_nm (Abbe number 56).
double acrylicDispersion(double wavelength_nm);

/// Density of water at 25 degrees, kg/m^3, linear in the salinity.
double waterDensity_kg_per_m3(double salinity_g_per_kg);

}  // namespace lodeline

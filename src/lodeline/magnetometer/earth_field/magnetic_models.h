#pragma once

#include <array>

namespace lodeline {

/// One term of a spherical harmonic magnetic model, Schmidt semi-normalized.
struct GaussCoefficient {
  int degree;
  int order;
  double g_nT, h_nT;                    ///< at the model's epoch
  double g_nT_per_year, h_nT_per_year;  ///< secular variation
};

constexpr int kMagneticModelDegree = 12;
/// Sorted by degree, then by order.
using CoefficientTable = std::array<GaussCoefficient, 90>;

/// World Magnetic Models 2015 (version 2 of 2018), 2020 and 2025 (NOAA National Centers for Environmental
/// Information and British Geological Survey, doi:10.25921/aqfd-sd83; public domain).
extern const CoefficientTable kWmm2015v2Coefficients, kWmm2020Coefficients, kWmm2025Coefficients;

/// International Geomagnetic Reference Field, 12th generation (IAGA; public domain), degrees up to 12. Its
/// secular variation is the difference to the model's next epoch.
extern const CoefficientTable kIgrf2000Coefficients, kIgrf2005Coefficients, kIgrf2010Coefficients;

/// A model and the five years for which it is used.
struct MagneticModel {
  const char* name;
  double epoch;  ///< decimal year, start of the five years
  const CoefficientTable* coefficients;
};
constexpr double kMagneticModel_years = 5.0;

inline constexpr std::array<MagneticModel, 6> kMagneticModels = {
    {{"IGRF-12", 2000.0, &kIgrf2000Coefficients},
     {"IGRF-12", 2005.0, &kIgrf2005Coefficients},
     {"IGRF-12", 2010.0, &kIgrf2010Coefficients},
     {"WMM2015v2", 2015.0, &kWmm2015v2Coefficients},
     {"WMM2020", 2020.0, &kWmm2020Coefficients},
     {"WMM2025", 2025.0, &kWmm2025Coefficients}}};

}  // namespace lodeline

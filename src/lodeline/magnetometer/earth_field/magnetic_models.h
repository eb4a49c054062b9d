#pragma once

#include <array>
#include <vector>

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

/// One coefficient of the International Geomagnetic Reference Field at each of its epochs.
struct IgrfRow {
  int degree;
  int order;
  int is_h;  ///< 0: the coefficient g of cos(order * longitude); 1: h of sin(order * longitude)
  std::array<double, 24> value_nT;
};
/// Sorted by degree, then by order, g before h.
using IgrfTable = std::array<IgrfRow, 168>;

/// International Geomagnetic Reference Field, 14th generation (IAGA; doi:10.5281/zenodo.14012302; public
/// domain) at 1900.0, 1905.0, ..., 2015.0, degrees up to 12. Between two epochs each coefficient is linear in
/// time.
extern const IgrfTable kIgrfCoefficients;

/// A model and the five years for which it is used.
struct MagneticModel {
  const char* name;
  double epoch;  ///< decimal year, start of the five years
  CoefficientTable coefficients;
};
constexpr double kMagneticModel_years = 5.0;

/// All models in the order of their years: IGRF-14 from 1900.0 to 2015.0, then the World Magnetic Models.
const std::vector<MagneticModel>& magneticModels();

}  // namespace lodeline

#pragma once

#include <array>

namespace lodeline {

/// One term of a spherical harmonic magnetic model, Schmidt semi-normalised.
struct GaussCoefficient {
  int degree;
  int order;
  double g_nT, h_nT;                    ///< at the model's epoch
  double g_nT_per_year, h_nT_per_year;  ///< secular variation
};

constexpr int kWmm2025Degree = 12;
constexpr double kWmm2025Epoch = 2025.0;  ///< decimal year; valid for five years from here

/// World Magnetic Model 2025 (NOAA National Centers for Environmental Information and British Geological
/// Survey, doi:10.25921/aqfd-sd83; public domain), in order of degree, then order.
extern const std::array<GaussCoefficient, 90> kWmm2025Coefficients;

}  // namespace lodeline

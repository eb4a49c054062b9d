#include "lodeline/magnetometer/earth_field/magnetic_models.h"

namespace lodeline {
namespace {

constexpr double kIgrfStart = 1900.0;

/// The coefficients of an IGRF epoch; their secular variation is the difference to the next epoch.
CoefficientTable igrfTable(std::size_t epoch) {
  CoefficientTable table = kWmm2025Coefficients;  // for its degrees and orders
  auto term = table.begin();
  for (const IgrfRow& row : kIgrfCoefficients) {
    if (row.degree != term->degree || row.order != term->order) {
      ++term;
    }
    const double value_nT = row.value_nT[epoch];
    const double rate_nT_per_year = (row.value_nT[epoch + 1] - value_nT) / kMagneticModel_years;
    (row.is_h ? term->h_nT : term->g_nT) = value_nT;
    (row.is_h ? term->h_nT_per_year : term->g_nT_per_year) = rate_nT_per_year;
  }
  return table;
}

std::vector<MagneticModel> allModels() {
  std::vector<MagneticModel> models;
  for (std::size_t epoch = 0; epoch + 1 < kIgrfCoefficients.front().value_nT.size(); ++epoch) {
    models.push_back({"IGRF-14", kIgrfStart + kMagneticModel_years * epoch, igrfTable(epoch)});
  }
  models.push_back({"WMM2015v2", 2015.0, kWmm2015v2Coefficients});
  models.push_back({"WMM2020", 2020.0, kWmm2020Coefficients});
  models.push_back({"WMM2025", 2025.0, kWmm2025Coefficients});
  return models;
}

}  // namespace

const std::vector<MagneticModel>& magneticModels() {
  static const std::vector<MagneticModel> models = allModels();
  return models;
}

}  // namespace lodeline

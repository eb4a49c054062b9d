#include "lodeline/estimator/visual/sighting_products.h"

#include "lodeline/util/wide_vectors.h"

namespace lodeline {
namespace {

constexpr int kCount = SightingColumns::kCount;

/// Adds a^T b to `sums`, a the columns from `first` on of both rows and b as many columns as `sums` has.
template <typename Sums>
inline __attribute__((always_inline)) void add(const double* __restrict rows, int first,
                                               double* __restrict sums) {
  for (int i = 0; i < Sums::RowsAtCompileTime; ++i) {
    const double u = rows[first + i], v = rows[kCount + first + i];
    double* __restrict sum = sums + i * Sums::ColsAtCompileTime;
    for (int j = 0; j < Sums::ColsAtCompileTime; ++j) sum[j] += u * rows[j] + v * rows[kCount + j];
  }
}

LODELINE_WIDE_VECTORS
void addHostProducts(const double* __restrict rows, double* __restrict sums) {
  add<HostProducts>(rows, SightingColumns::kHost, sums);
}

LODELINE_WIDE_VECTORS
void addCalibrationProducts(const double* __restrict rows, double* __restrict sums) {
  add<CalibrationProducts>(rows, SightingColumns::kLens, sums);
}

}  // namespace

void addProducts(const SightingRows& sighting, HostProducts* sums) {
  addHostProducts(sighting.data(), sums->data());
}

void addProducts(const SightingRows& sighting, CalibrationProducts* sums) {
  addCalibrationProducts(sighting.data(), sums->data());
}

}  // namespace lodeline

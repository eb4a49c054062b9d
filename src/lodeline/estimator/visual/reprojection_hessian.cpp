#include "lodeline/estimator/visual/reprojection_hessian.h"

#include "lodeline/util/simd_dispatch.h"

namespace lodeline {
namespace {

constexpr int kCount = ObservationColumns::kCount;

/// Adds a^T b to `sums`, where a has the columns from `first` on of both rows, and b as many columns as
/// `sums`.
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
  add<HostProducts>(rows, ObservationColumns::kHost, sums);
}

LODELINE_WIDE_VECTORS
void addCalibrationProducts(const double* __restrict rows, double* __restrict sums) {
  add<CalibrationProducts>(rows, ObservationColumns::kIntrinsics, sums);
}

}  // namespace

void addProducts(const ObservationRows& observation, HostProducts* sums) {
  addHostProducts(observation.data(), sums->data());
}

void addProducts(const ObservationRows& observation, CalibrationProducts* sums) {
  addCalibrationProducts(observation.data(), sums->data());
}

}  // namespace lodeline

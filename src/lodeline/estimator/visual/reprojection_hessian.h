#pragma once

#include <Eigen/Core>

#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {

/// Columns of the two rows of an observation: its derivatives by the intrinsics of its camera, by the
/// extrinsics of a secondary camera and by the pose of its landmark's host (zero where there is none). The
/// residual is one more column, because gradients are summed like Hessians. The last columns are empty, so
/// that rows are whole SIMD vectors.
struct ObservationColumns {
  static constexpr int kIntrinsics = 0, kSecondary = kIntrinsicsSize, kResidual = kSecondary + 6,
                       kHost = kResidual + 1, kCount = (kHost + 6 + 3) / 4 * 4;
};
using ObservationRows = Eigen::Matrix<double, 2, ObservationColumns::kCount, Eigen::RowMajor>;

/// Sums of products of the derivatives by the host's pose with all columns.
using HostProducts = Eigen::Matrix<double, 6, ObservationColumns::kCount, Eigen::RowMajor>;
/// The same products of the derivatives by intrinsics and extrinsics. The last columns have no meaning there.
/// With rows of 16, however, GCC 12 unrolls the sums completely and gathers them across rows, which takes
/// several times as long.
using CalibrationProducts =
    Eigen::Matrix<double, ObservationColumns::kResidual, ObservationColumns::kCount, Eigen::RowMajor>;

void addProducts(const ObservationRows& observation, HostProducts* sums);
void addProducts(const ObservationRows& observation, CalibrationProducts* sums);

}  // namespace lodeline

#pragma once

#include <Eigen/Core>

#include "lodeline/factors/intrinsics_factor.h"

namespace lodeline {

/// Columns of the two rows of an observation: its derivatives by the camera's intrinsics, a secondary
/// camera's extrinsics and the pose of the landmark's host (zero where there is none). The residual is one
/// more column, because gradients are summed like Hessians. Another is the derivative by the line delay of
/// the camera, zero for a global shutter. Rows are whole SIMD vectors.
struct ObservationColumns {
  static constexpr int kIntrinsics = 0, kSecondary = kIntrinsicsSize, kResidual = kSecondary + 6,
                       kHost = kResidual + 1, kLineDelay = kHost + 6, kCount = (kLineDelay + 4) / 4 * 4;
};
using ObservationRows = Eigen::Matrix<double, 2, ObservationColumns::kCount, Eigen::RowMajor>;

/// Sums of products of the derivatives by the host's pose with all columns.
using HostProducts = Eigen::Matrix<double, 6, ObservationColumns::kCount, Eigen::RowMajor>;
/// The same products of the derivatives by intrinsics and extrinsics. The columns of the host have no meaning
/// there. With rows of 16, however, GCC 12 unrolls the sums completely and gathers them across rows, which
/// takes several times as long.
using CalibrationProducts =
    Eigen::Matrix<double, ObservationColumns::kResidual, ObservationColumns::kCount, Eigen::RowMajor>;

void addProducts(const ObservationRows& observation, HostProducts* sums);
void addProducts(const ObservationRows& observation, CalibrationProducts* sums);

}  // namespace lodeline

#pragma once

#include <Eigen/Core>

namespace lodeline {

/// Columns of the two rows of an observation: its derivatives by the intrinsics of its camera, by the
/// extrinsics of a secondary camera and by the pose of its landmark's host (zero where there is none). The
/// residual is one more column, because gradients are summed like Hessians. The last column is the derivative
/// by the line delay of the camera, zero for a global shutter. Rows are whole SIMD vectors.
struct ObservationColumns {
  static constexpr int kIntrinsics = 0, kSecondary = 6, kResidual = 12, kHost = 13, kLineDelay = 19,
                       kCount = 20;
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

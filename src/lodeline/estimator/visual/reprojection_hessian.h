#pragma once

#include <Eigen/Core>

namespace lodeline {

/// An observation's two rows: its derivatives by the lens of its camera, by the extrinsics of a secondary
/// camera and by the pose of its landmark's host, zero where there is none, and among them the residual,
/// since gradients add up as Hessians do. The last column is empty, so that rows are whole vectors.
struct ObservationColumns {
  static constexpr int kIntrinsics = 0, kSecondary = 6, kResidual = 12, kHost = 13, kCount = 20;
};
using ObservationRows = Eigen::Matrix<double, 2, ObservationColumns::kCount, Eigen::RowMajor>;

/// Sums of products of the derivatives by the host's pose with all columns.
using HostProducts = Eigen::Matrix<double, 6, ObservationColumns::kCount, Eigen::RowMajor>;
/// The same of the derivatives by lens and extrinsics. The last columns mean nothing there, but with rows of
/// 16 GCC 12 unrolls the sums whole and gathers them across rows, which takes several times as long.
using CalibrationProducts =
    Eigen::Matrix<double, ObservationColumns::kResidual, ObservationColumns::kCount, Eigen::RowMajor>;

void addProducts(const ObservationRows& observation, HostProducts* sums);
void addProducts(const ObservationRows& observation, CalibrationProducts* sums);

}  // namespace lodeline

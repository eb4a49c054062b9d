#pragma once

#include <Eigen/Core>

namespace lodeline {

/// A sighting's two rows: its derivatives by the lens of its camera, by the extrinsics of a further camera
/// and by the pose of its landmark's host, zero where there is none, and among them the residual, since
/// gradients add up as Hessians do. The last column is empty, so that rows are whole vectors.
struct SightingColumns {
  static constexpr int kLens = 0, kFurther = 6, kResidual = 12, kHost = 13, kCount = 20;
};
using SightingRows = Eigen::Matrix<double, 2, SightingColumns::kCount, Eigen::RowMajor>;

/// Sums of products of the derivatives by the host's pose with all columns.
using HostProducts = Eigen::Matrix<double, 6, SightingColumns::kCount, Eigen::RowMajor>;
/// The same of the derivatives by lens and extrinsics. The last columns mean nothing there, but with rows of
/// 16 GCC 12 unrolls the sums whole and gathers them across rows, which takes several times as long.
using CalibrationProducts =
    Eigen::Matrix<double, SightingColumns::kResidual, SightingColumns::kCount, Eigen::RowMajor>;

void addProducts(const SightingRows& sighting, HostProducts* sums);
void addProducts(const SightingRows& sighting, CalibrationProducts* sums);

}  // namespace lodeline

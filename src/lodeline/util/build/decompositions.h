/// Declares the decompositions of Eigen that many files use. decompositions.cpp compiles them once. Without
/// this header every file compiles them again, which takes GCC up to 12 s for each one. The
/// precompiled headers include it. A build without these gives the same program.
#pragma once
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

/// Explicit instantiations for the square matrix MATRIX. WHERE: `extern` to declare them, empty to define
/// them.
#define LODELINE_SYMMETRIC_DECOMPOSITIONS(WHERE, MATRIX)                                  \
  WHERE template SelfAdjointEigenSolver<MATRIX>& SelfAdjointEigenSolver<MATRIX>::compute( \
      const EigenBase<MATRIX>&, int);                                                     \
  WHERE template LLT<MATRIX>& LLT<MATRIX>::compute(const EigenBase<MATRIX>&);             \
  WHERE template LDLT<MATRIX>& LDLT<MATRIX>::compute(const EigenBase<MATRIX>&);

#define LODELINE_DECOMPOSITIONS(WHERE)                                                                \
  LODELINE_SYMMETRIC_DECOMPOSITIONS(WHERE, Matrix2d)                                                  \
  LODELINE_SYMMETRIC_DECOMPOSITIONS(WHERE, Matrix3d)                                                  \
  LODELINE_SYMMETRIC_DECOMPOSITIONS(WHERE, Matrix6d)                                                  \
  LODELINE_SYMMETRIC_DECOMPOSITIONS(WHERE, MatrixXd)                                                  \
  WHERE template JacobiSVD<Matrix3d>& JacobiSVD<Matrix3d>::compute(const Matrix3d&, unsigned int);    \
  WHERE template JacobiSVD<Matrix23d>& JacobiSVD<Matrix23d>::compute(const Matrix23d&, unsigned int); \
  WHERE template void HouseholderQR<MatrixXd>::computeInPlace();                                      \
  WHERE template void ColPivHouseholderQR<MatrixXd>::computeInPlace();                                \
  WHERE template void PartialPivLU<MatrixXd>::compute();

namespace Eigen {
using Matrix6d = Matrix<double, 6, 6>;
using Matrix23d = Matrix<double, 2, 3>;  // Quaternion::FromTwoVectors decomposes it
LODELINE_DECOMPOSITIONS(extern)
}  // namespace Eigen

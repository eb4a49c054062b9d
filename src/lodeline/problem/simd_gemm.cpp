#include "lodeline/problem/simd_gemm.h"

#include <algorithm>

#include "lodeline/util/simd_dispatch.h"

namespace lodeline {
namespace {

/// Tile of c that is summed in registers: rows in pieces of four, and columns.
constexpr Eigen::Index kPiece = 4, kTileColumns = 6;

using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;

/// Columns of a matrix at a distance of `stride` elements.
template <typename Scalar>
struct Strided {
  Scalar* data;
  Eigen::Index stride;

  Strided from(Eigen::Index row, Eigen::Index column = 0) const {
    return {data + row + column * stride, stride};
  }
};
using StridedInput = Strided<const double>;
using StridedOutput = Strided<double>;

template <int kPieces, int kColumns>
struct TileSums {
  Four of[kPieces][kColumns] = {};
};

template <int kPieces, int kColumns>
inline __attribute__((always_inline)) TileSums<kPieces, kColumns> sumTile(StridedInput a, StridedInput b,
                                                                          Eigen::Index depth) {
  TileSums<kPieces, kColumns> sums;
  for (Eigen::Index k = 0; k < depth; ++k) {
    const Four* rows = reinterpret_cast<const Four*>(a.data + k * a.stride);
    for (int j = 0; j < kColumns; ++j) {
      const double column = b.data[k * b.stride + j];
      for (int piece = 0; piece < kPieces; ++piece) sums.of[piece][j] += rows[piece] * column;
    }
  }
  return sums;
}

template <int kPieces, int kColumns>
inline __attribute__((always_inline)) void subtractTile(StridedInput a, StridedInput b, Eigen::Index depth,
                                                        StridedOutput c) {
  const auto sums = sumTile<kPieces, kColumns>(a, b, depth);
  for (int j = 0; j < kColumns; ++j) {
    Four* rows = reinterpret_cast<Four*>(c.data + j * c.stride);
    for (int piece = 0; piece < kPieces; ++piece) rows[piece] -= sums.of[piece][j];
  }
}

/// Processes the last rows of a piece whose first `skipped` rows belong to another piece.
template <int kColumns>
inline __attribute__((always_inline)) void subtractRest(StridedInput a, StridedInput b, Eigen::Index depth,
                                                        Eigen::Index skipped, StridedOutput c) {
  const auto sums = sumTile<1, kColumns>(a, b, depth);
  for (int j = 0; j < kColumns; ++j) {
    for (Eigen::Index i = skipped; i < kPiece; ++i) c.data[j * c.stride + i] -= sums.of[0][j][i];
  }
}

/// Processes fewer rows than one piece.
inline __attribute__((always_inline)) void subtractFew(StridedInput a, StridedInput b, Eigen::Index rows,
                                                       Eigen::Index columns, Eigen::Index depth,
                                                       StridedOutput c) {
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      double sum = 0.0;
      for (Eigen::Index k = 0; k < depth; ++k) sum += a.data[k * a.stride + i] * b.data[k * b.stride + j];
      c.data[j * c.stride + i] -= sum;
    }
  }
}

template <int kColumns>
inline __attribute__((always_inline)) void subtractColumns(StridedInput a, StridedInput b, Eigen::Index rows,
                                                           Eigen::Index depth, StridedOutput c) {
  Eigen::Index row = 0;
  for (; row + 2 * kPiece <= rows; row += 2 * kPiece)
    subtractTile<2, kColumns>(a.from(row), b, depth, c.from(row));
  for (; row + kPiece <= rows; row += kPiece) subtractTile<1, kColumns>(a.from(row), b, depth, c.from(row));
  if (row == rows) return;
  const Eigen::Index last = rows - kPiece;
  subtractRest<kColumns>(a.from(last), b, depth, row - last, c.from(last));
}

LODELINE_WIDE_VECTORS
void subtract(StridedInput a, StridedInput b, Eigen::Index rows, Eigen::Index columns, Eigen::Index depth,
              StridedOutput c) {
  if (rows < kPiece) return subtractFew(a, b, rows, columns, depth, c);
  Eigen::Index column = 0;
  for (; column + kTileColumns <= columns; column += kTileColumns)
    subtractColumns<kTileColumns>(a, b.from(column), rows, depth, c.from(0, column));
  for (; column < columns; ++column) subtractColumns<1>(a, b.from(column), rows, depth, c.from(0, column));
}

}  // namespace

void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                     Eigen::Ref<Eigen::MatrixXd> c) {
  subtract({a.data(), a.outerStride()}, {b.data(), b.outerStride()}, a.rows(), b.rows(), a.cols(),
           {c.data(), c.outerStride()});
}

void subtractSquare(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::Ref<Eigen::MatrixXd> c) {
  const StridedInput all{a.data(), a.outerStride()};
  const StridedOutput triangle{c.data(), c.outerStride()};
  for (Eigen::Index column = 0; column < a.rows(); column += kTileColumns) {
    const Eigen::Index columns = std::min(kTileColumns, a.rows() - column);
    subtract(all.from(column), all.from(column), a.rows() - column, columns, a.cols(),
             triangle.from(column, column));
  }
}

}  // namespace lodeline

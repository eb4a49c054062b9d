#include "lodeline/inspection/survey/signed_axes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace lodeline {
namespace {

std::vector<Mat3> makeSignedAxes() {
  std::vector<Mat3> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 matrix = Mat3::Zero();
      for (int row = 0; row < 3; ++row) {
        matrix(row, order[static_cast<size_t>(row)]) = (signs >> row & 1) != 0 ? -1.0 : 1.0;
      }
      all.push_back(matrix);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

}  // namespace

const std::vector<Mat3>& signedAxes() {
  static const std::vector<Mat3> all = makeSignedAxes();
  return all;
}

Mat3 nearestSignedAxes(const Mat3& matrix) {
  const auto likeness = [&](const Mat3& candidate) { return candidate.cwiseProduct(matrix).sum(); };
  return *std::max_element(signedAxes().begin(), signedAxes().end(),
                           [&](const Mat3& a, const Mat3& b) { return likeness(a) < likeness(b); });
}

std::string describeSignedAxes(const Mat3& true_from_given) {
  constexpr std::string_view kNames = "xyz";
  std::string text;
  for (int row = 0; row < 3; ++row) {
    int column = 0;
    true_from_given.row(row).cwiseAbs().maxCoeff(&column);
    text += fmt::format("{}{} is {}{}", row == 0 ? "" : ", ", kNames[static_cast<size_t>(row)],
                        true_from_given(row, column) < 0.0 ? "-" : "", kNames[static_cast<size_t>(column)]);
  }
  return text;
}

}  // namespace lodeline

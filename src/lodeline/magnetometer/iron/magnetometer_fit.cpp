#include "lodeline/magnetometer/iron/magnetometer_fit.h"

#include <fmt/core.h>

#include <array>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"

namespace lodeline {
namespace {

constexpr std::array<std::pair<IronModel, const char*>, 5> kNames = {{{IronModel::Full, "full"},
                                                                      {IronModel::Diagonal, "diagonal"},
                                                                      {IronModel::Scale, "scale"},
                                                                      {IronModel::Offset, "offset"},
                                                                      {IronModel::Kept, "kept"}}};

}  // namespace

const char* toString(IronModel model) {
  for (const auto& [value, name] : kNames) {
    if (value == model) return name;
  }
  return "";
}

IronModel ironModelFromString(const std::string& name, const std::string& where) {
  for (const auto& [value, known] : kNames) {
    if (equalIgnoringCase(name, known)) return value;
  }
  throw InputError(fmt::format("{} is '{}'; it must be full, diagonal, scale, offset or kept", where, name));
}

Mat3 symmetricMatrix(const Eigen::Matrix<double, 6, 1>& e) {
  Mat3 matrix;
  matrix << e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2];
  return matrix;
}

Eigen::Matrix<double, 6, 1> symmetricEntries(const Mat3& m) {
  Eigen::Matrix<double, 6, 1> entries;
  entries << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2);
  return entries;
}

}  // namespace lodeline

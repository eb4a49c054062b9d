#include "lodeline/magnetometer/field_map/potential_basis.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"

namespace lodeline {

PotentialBasis::PotentialBasis(double half_size_m, double length_scale_m, double field_sigma_T)
    : half_size_m_(half_size_m) {
  if (!(length_scale_m > 0.0) || !(field_sigma_T > 0.0) || !(half_size_m >= length_scale_m)) {
    throw UsageError(fmt::format(
        "a map of the field with boxes of {} m on each side of their centres, a length scale of {} "
        "m and {} T does not exist: give positive values, and boxes not below the length scale",
        half_size_m, length_scale_m, field_sigma_T));
  }
  const double step = std::numbers::pi / (2.0 * half_size_m);  // rad/m for each unit of an index
  const double cut_off = kCutOff / length_scale_m;
  greatest_index_ = static_cast<int>(cut_off / step);
  const double potential_sigma = field_sigma_T * length_scale_m;
  const double density = potential_sigma * potential_sigma *
                         std::pow(2.0 * std::numbers::pi * length_scale_m * length_scale_m, 1.5);
  std::vector<double> variances;
  for (int x = 1; x <= greatest_index_; ++x) {
    for (int y = 1; y <= greatest_index_; ++y) {
      for (int z = 1; z <= greatest_index_; ++z) {
        const double eigenvalue = step * step * (x * x + y * y + z * z);
        if (eigenvalue > cut_off * cut_off) continue;
        indices_.emplace_back(x, y, z);
        variances.push_back(density * std::exp(-0.5 * eigenvalue * length_scale_m * length_scale_m));
      }
    }
  }
  weight_variances_ =
      Eigen::Map<Eigen::VectorXd>(variances.data(), static_cast<Eigen::Index>(variances.size()));
}

PotentialBasis::Axis PotentialBasis::along(double coordinate_m) const {
  const Eigen::ArrayXd rates = std::numbers::pi / (2.0 * half_size_m_) *
                               Eigen::ArrayXd::LinSpaced(greatest_index_, 1.0, greatest_index_);
  const Eigen::ArrayXd angles = rates * (coordinate_m + half_size_m_);
  const double scale = 1.0 / std::sqrt(half_size_m_);
  Axis axis;
  axis.value = scale * angles.sin();
  axis.first = scale * rates * angles.cos();
  axis.second = -rates * rates * axis.value;
  return axis;
}

PotentialBasis::Gradients PotentialBasis::gradients(const Vec3& point) const {
  const Axis x = along(point.x()), y = along(point.y()), z = along(point.z());
  Gradients gradients(3, size());
  for (int j = 0; j < size(); ++j) {
    const Eigen::Vector3i n = indices_[static_cast<size_t>(j)].array() - 1;
    gradients.col(j) << x.first[n.x()] * y.value[n.y()] * z.value[n.z()],
        x.value[n.x()] * y.first[n.y()] * z.value[n.z()], x.value[n.x()] * y.value[n.y()] * z.first[n.z()];
  }
  return gradients;
}

Mat3 PotentialBasis::fieldByPoint(const Vec3& point, const Eigen::VectorXd& weights) const {
  const Axis x = along(point.x()), y = along(point.y()), z = along(point.z());
  Mat3 derivative = Mat3::Zero();
  for (int j = 0; j < size(); ++j) {
    const Eigen::Vector3i n = indices_[static_cast<size_t>(j)].array() - 1;
    const double w = weights[j];
    derivative(0, 0) += w * x.second[n.x()] * y.value[n.y()] * z.value[n.z()];
    derivative(1, 1) += w * x.value[n.x()] * y.second[n.y()] * z.value[n.z()];
    derivative(2, 2) += w * x.value[n.x()] * y.value[n.y()] * z.second[n.z()];
    derivative(0, 1) += w * x.first[n.x()] * y.first[n.y()] * z.value[n.z()];
    derivative(0, 2) += w * x.first[n.x()] * y.value[n.y()] * z.first[n.z()];
    derivative(1, 2) += w * x.value[n.x()] * y.first[n.y()] * z.first[n.z()];
  }
  return derivative.selfadjointView<Eigen::Upper>();
}

}  // namespace lodeline

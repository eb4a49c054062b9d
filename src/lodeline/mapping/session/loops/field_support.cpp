#include "lodeline/mapping/session/loops/field_support.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/robust/robust_weights.h"

namespace lodeline {
namespace {

/// A reading at a pose in axes of one body.
struct PlacedField {
  Rigid3 pose;
  KeyframeField reading;
  int dive = 0;  ///< two dives have different sensors, or calibrations of one

  Vec3 turned() const { return pose.rotation * reading.field_B; }
};
using PlacedFields = std::vector<PlacedField>;

/// Readings near a keyframe, on the path from `from_m` (without) to `to_m` (with) after it, in its body frame
/// by odometry.
PlacedFields readingsAround(const KnownKeyframes& known, KeyframeId id, double from_m, double to_m) {
  const std::vector<KnownKeyframe>& all = known.all();
  const KnownKeyframe& middle = known.at(id);
  PlacedFields readings;
  const auto add = [&](const KnownKeyframe& keyframe) {
    if (keyframe.dive != middle.dive) return false;
    const double along_m = keyframe.path_m - middle.path_m;
    if (along_m <= from_m || along_m > to_m) return false;
    if (keyframe.field)
      readings.push_back(
          {middle.odom_from_body.inverse() * keyframe.odom_from_body, *keyframe.field, keyframe.dive});
    return true;
  };
  const auto index = static_cast<size_t>(&middle - all.data());
  for (size_t i = index; i < all.size() && add(all[i]); ++i) {
  }
  for (size_t i = index; i > 0 && add(all[i - 1]); --i) {
  }
  return readings;
}

PlacedFields moved(const Rigid3& target_from_source, PlacedFields readings) {
  for (PlacedField& placed : readings) placed.pose = target_from_source * placed.pose;
  return readings;
}

/// Leaves the readings that have one of the others within a distance.
void keepNear(const PlacedFields& others, double distance_m, PlacedFields* readings) {
  std::erase_if(*readings, [&](const PlacedField& placed) {
    return std::none_of(others.begin(), others.end(), [&](const PlacedField& other) {
      return (placed.pose.translation - other.pose.translation).norm() < distance_m;
    });
  });
}

/// Sum of squared differences of the fields from their mean, T^2.
double squaredVariation(const PlacedFields& readings) {
  Vec3 mean = Vec3::Zero();
  for (const PlacedField& placed : readings) mean += placed.turned() / static_cast<double>(readings.size());
  double sum = 0.0;
  for (const PlacedField& placed : readings) sum += (placed.turned() - mean).squaredNorm();
  return sum;
}

/// Whether the field varies along the ways by more than the noise, each way for itself.
bool varies(const PlacedFields& old_way, const PlacedFields& new_way, const FieldSupportOptions& options) {
  constexpr double kNoises = 3.0;
  const double ways = new_way.empty() ? 1.0 : 2.0;
  const double freedom = 3.0 * (static_cast<double>(old_way.size() + new_way.size()) - ways);
  double noise_T = 0.0;
  for (const PlacedFields* way : {&old_way, &new_way}) {
    for (const PlacedField& placed : *way) noise_T = std::max(noise_T, placed.reading.sigma_T);
  }
  const double variation_T = std::sqrt((squaredVariation(old_way) + squaredVariation(new_way)) / freedom);
  return variation_T > std::max(options.least_variation_T, kNoises * noise_T);
}

/// Covariance of the fields of two readings, T^2, without independent noise. The anomaly is the gradient of a
/// Gaussian process with a squared exponential covariance, as in the field map.
Mat3 shared(const PlacedField& a, const PlacedField& b, bool same_place, const FieldSupportOptions& options) {
  Mat3 covariance = options.earth_sigma_T * options.earth_sigma_T * Mat3::Identity();
  if (a.dive == b.dive) {
    const double error_T2 =
        options.offset_sigma_T * options.offset_sigma_T +
        options.axes_sigma * options.axes_sigma * a.reading.field_B.dot(b.reading.field_B);
    covariance += error_T2 * (a.pose.rotation * b.pose.rotation.conjugate()).toRotationMatrix();
  }
  if (!same_place) return covariance;
  const Vec3 apart = (a.pose.translation - b.pose.translation) / options.map.length_scale_m;
  const double variance_T2 =
      options.map.field_sigma_T * options.map.field_sigma_T * std::exp(-0.5 * apart.squaredNorm());
  return covariance + variance_T2 * (Mat3::Identity() - apart * apart.transpose());
}

Eigen::MatrixXd covarianceOf(const PlacedFields& rows, const PlacedFields& columns, bool same_place,
                             const FieldSupportOptions& options) {
  Eigen::MatrixXd covariance(3 * rows.size(), 3 * columns.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    for (size_t j = 0; j < columns.size(); ++j) {
      covariance.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
          shared(rows[i], columns[j], same_place, options);
    }
  }
  return covariance;
}

Eigen::MatrixXd covarianceOf(const PlacedFields& way, const FieldSupportOptions& options) {
  Eigen::MatrixXd covariance = covarianceOf(way, way, true, options);
  for (size_t i = 0; i < way.size(); ++i) {
    const double sigma_T = std::hypot(way[i].reading.sigma_T, options.floor_T);
    covariance.diagonal().segment<3>(static_cast<Eigen::Index>(3 * i)).array() += sigma_T * sigma_T;
  }
  return covariance;
}

Eigen::VectorXd stacked(const PlacedFields& way) {
  Eigen::VectorXd fields(3 * way.size());
  for (size_t i = 0; i < way.size(); ++i)
    fields.segment<3>(static_cast<Eigen::Index>(3 * i)) = way[i].turned();
  return fields;
}

struct Likelihood {
  double chi_squared = 0.0, log_determinant = 0.0;
};

/// Prediction of the fields of a new way from those of an old way. `same_place`: the anomaly at a place is
/// the same on both ways; otherwise both have only the Earth's field and the sensor's errors in common.
class WayPrediction {
 public:
  WayPrediction(PlacedFields old_way, bool same_place, const FieldSupportOptions& options)
      : old_way_(std::move(old_way)),
        same_place_(same_place),
        options_(options),
        information_(covarianceOf(old_way_, options)),
        weights_(information_.solve(stacked(old_way_))) {}

  /// `new_in_new`: in axes of the new body, whose pose in the old body is `pose`, with its covariance.
  Likelihood of(const PlacedFields& new_in_new, const Rigid3& pose, const Mat6& covariance) const {
    const PlacedFields new_way = moved(pose, new_in_new);
    const Eigen::MatrixXd common = covarianceOf(new_way, old_way_, same_place_, options_);
    const Eigen::MatrixXd by_pose = derivative(new_in_new, pose);
    const Eigen::MatrixXd expected = covarianceOf(new_way, options_) -
                                     common * information_.solve(common.transpose()) +
                                     by_pose * covariance * by_pose.transpose();
    const Eigen::VectorXd error = stacked(new_way) - common * weights_;
    const Eigen::LLT<Eigen::MatrixXd> factor(expected);
    const Eigen::MatrixXd lower = factor.matrixL();
    return {error.dot(factor.solve(error)), 2.0 * lower.diagonal().array().log().sum()};
  }

 private:
  Eigen::VectorXd errorAt(const PlacedFields& new_in_new, const Rigid3& pose) const {
    const PlacedFields new_way = moved(pose, new_in_new);
    return stacked(new_way) - covarianceOf(new_way, old_way_, same_place_, options_) * weights_;
  }

  /// Derivative of the error with respect to [dp, dtheta] of the pose, by central differences.
  Eigen::MatrixXd derivative(const PlacedFields& new_in_new, const Rigid3& pose) const {
    constexpr double kStep_m = 0.01, kStep_rad = 0.002;
    Eigen::MatrixXd by_pose(3 * new_in_new.size(), 6);
    for (int axis = 0; axis < 6; ++axis) {
      const double step = axis < 3 ? kStep_m : kStep_rad;
      const auto shifted = [&](double by) {
        const Vec3 along = by * Vec3::Unit(axis % 3);
        return axis < 3 ? Rigid3(pose.rotation, pose.translation + along)
                        : Rigid3(so3::exp(along) * pose.rotation, pose.translation);
      };
      by_pose.col(axis) =
          (errorAt(new_in_new, shifted(step)) - errorAt(new_in_new, shifted(-step))) / (2.0 * step);
    }
    return by_pose;
  }

  PlacedFields old_way_;
  bool same_place_;
  FieldSupportOptions options_;
  Eigen::LLT<Eigen::MatrixXd> information_;
  Eigen::VectorXd weights_;
};

}  // namespace

std::optional<FieldAgreement> fieldSupport(const KnownKeyframes& known, const Loop& loop,
                                           const FieldSupportOptions& given_options) {
  const KnownKeyframe &old_keyframe = known.at(loop.old_keyframe),
                      &new_keyframe = known.at(loop.new_keyframe);
  const bool is_one_dive = old_keyframe.dive == new_keyframe.dive;
  FieldSupportOptions options = given_options;
  if (!is_one_dive) {
    options.offset_sigma_T = options.other_offset_sigma_T;
    options.axes_sigma = options.other_axes_sigma;
  }
  // Two places of one way share no reading.
  const double between_m = is_one_dive
                               ? std::min(options.reach_m, 0.5 * (new_keyframe.path_m - old_keyframe.path_m))
                               : options.reach_m;
  PlacedFields old_way = readingsAround(known, loop.old_keyframe, -options.reach_m, between_m);
  PlacedFields new_in_new = readingsAround(known, loop.new_keyframe, -between_m, options.reach_m);
  const Rigid3 new_from_old = loop.old_from_new.inverse();
  keepNear(moved(new_from_old, old_way), options.map.length_scale_m, &new_in_new);
  if (static_cast<int>(new_in_new.size()) < options.least_readings) return std::nullopt;
  if (static_cast<int>(old_way.size()) < options.least_readings) return std::nullopt;
  if (!varies(old_way, new_in_new, options)) return std::nullopt;
  const Likelihood same =
      WayPrediction(old_way, true, options).of(new_in_new, loop.old_from_new, loop.covariance);
  const Likelihood other =
      WayPrediction(std::move(old_way), false, options).of(new_in_new, loop.old_from_new, loop.covariance);
  FieldAgreement agreement;
  agreement.chi_squared = same.chi_squared;
  agreement.values = static_cast<int>(3 * new_in_new.size());
  agreement.log_ratio =
      0.5 * (other.chi_squared + other.log_determinant) - 0.5 * (same.chi_squared + same.log_determinant);
  return agreement;
}

bool isFieldTelling(const KnownKeyframes& known, const Loop& loop, const FieldSupportOptions& options) {
  if (!known.at(loop.new_keyframe).field) return false;
  const PlacedFields old_way = readingsAround(known, loop.old_keyframe, -options.reach_m, options.reach_m);
  return static_cast<int>(old_way.size()) >= options.least_readings && varies(old_way, {}, options);
}

bool areSupportedByField(const std::vector<Loop>& loops, const FieldSupportOptions& options) {
  int supported = 0, other = 0;
  for (const Loop& loop : loops) {
    if (!loop.field || loop.field->values < options.supporting_values) continue;
    ++(loop.field->log_ratio > options.supporting_log_ratio ? supported : other);
  }
  return supported > other;
}

void judgeByField(const KnownKeyframes& known, Loop* loop, const FieldSupportOptions& options) {
  loop->field = fieldSupport(known, *loop, options);
  if (!loop->field || loop->status != LoopStatus::Verified) return;
  if (so3::log(loop->old_from_new.rotation).norm() > options.most_turn_rad) return;
  const FieldAgreement& field = *loop->field;
  if (field.log_ratio >= options.least_log_ratio) return;
  if (field.chi_squared <= chiSquaredQuantile(options.contradiction_probability, field.values)) return;
  loop->status = LoopStatus::Refused;
  loop->reason = fmt::format("the magnetic fields of both ways differ: chi-squared {:.0f} of {} values",
                             field.chi_squared, field.values);
}

}  // namespace lodeline

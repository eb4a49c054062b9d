#include "lodeline/trajectory.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"

namespace lodeline {
namespace {

// Ratio of the second to the first singular value of the cross-covariance below which the points count as one
// line: position noise would determine the rotation about it.
constexpr double kDegenerateRatio = 1e-9;

// Ratio of the positions' standard deviation to their size below which they are equal, except for rounding.
constexpr double kRestingRatio = 1e-12;

struct Moments {
  Vec3 estimate_mean = Vec3::Zero();
  Vec3 reference_mean = Vec3::Zero();
  double estimate_variance = 0.0;
  double reference_variance = 0.0;
  Mat3 covariance = Mat3::Zero();  ///< of reference (rows) with estimate (columns)

  bool estimateRests() const { return rests(estimate_variance, estimate_mean); }
  bool referenceRests() const { return rests(reference_variance, reference_mean); }

 private:
  static bool rests(double variance, const Vec3& mean) {
    return std::sqrt(variance) <= kRestingRatio * mean.norm();
  }
};

Moments computeMoments(const PosePairs& pairs) {
  Moments m;
  const double n = static_cast<double>(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    m.estimate_mean += pairs.estimate[i].translation / n;
    m.reference_mean += pairs.reference[i].translation / n;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Vec3 estimate = pairs.estimate[i].translation - m.estimate_mean;
    const Vec3 reference = pairs.reference[i].translation - m.reference_mean;
    m.estimate_variance += estimate.squaredNorm() / n;
    m.reference_variance += reference.squaredNorm() / n;
    m.covariance += reference * estimate.transpose() / n;
  }
  return m;
}

/// The rotation R that maximizes trace(R^T * covariance), and the maximum of the trace.
struct Rotation {
  Mat3 matrix = Mat3::Identity();
  double trace = 0.0;
  bool determined = false;
};

Rotation bestRotation(const Mat3& covariance) {
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) signs.z() = -1.0;
  const Vec3& singular = svd.singularValues();
  return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(), singular.dot(signs),
          singular(0) > 0.0 && singular(1) > kDegenerateRatio * singular(0)};
}

/// The rotation about z that maximizes trace(Rz^T * covariance).
Rotation bestYaw(const Mat3& covariance) {
  const double sine = covariance(1, 0) - covariance(0, 1);
  const double cosine = covariance(0, 0) + covariance(1, 1);
  const double yaw_rad = std::atan2(sine, cosine);
  const bool determined = std::hypot(sine, cosine) > kDegenerateRatio * covariance.norm();
  return {Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()).toRotationMatrix(), 0.0, determined};
}

Rotation best(AlignmentType type, const Mat3& covariance) {
  return type == AlignmentType::Yaw ? bestYaw(covariance) : bestRotation(covariance);
}

/// Sum of the rotations from the estimate's to the reference's world; its projection is their chordal mean.
Mat3 orientationMoments(const PosePairs& pairs, std::size_t count) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    sum += (pairs.reference[i].rotation * pairs.estimate[i].rotation.conjugate()).toRotationMatrix();
  }
  return sum;
}

constexpr std::array<const char*, 4> kTypeNames = {"none", "yaw", "se3", "sim3"};

}  // namespace

const char* toString(AlignmentType type) { return kTypeNames.at(static_cast<std::size_t>(type)); }

AlignmentType alignmentTypeFromString(const std::string& name) {
  const std::vector<std::string> names(kTypeNames.begin(), kTypeNames.end());
  return static_cast<AlignmentType>(chooseByName("alignment", name, names));
}

Rigid3 Alignment::apply(const Rigid3& estimate_world_from_body) const {
  return reference_from_estimate *
         Rigid3(estimate_world_from_body.rotation, scale * estimate_world_from_body.translation);
}

Alignment align(AlignmentType type, const PosePairs& pairs) {
  if (pairs.size() == 0) throw InputError("no pairs of poses to align");
  Alignment result;
  if (type == AlignmentType::None) return result;
  const Moments moments = computeMoments(pairs);
  const bool one_place = moments.estimateRests() || moments.referenceRests();
  Rotation rotation = best(type, moments.covariance);
  if (type == AlignmentType::Sim3) {
    if (one_place || rotation.trace <= 0.0) {
      throw InputError(
          fmt::format("the {} pairs of poses leave the scale open: estimate or reference does not move; "
                      "use another alignment than sim3",
                      pairs.size()));
    }
    result.scale = rotation.trace / moments.estimate_variance;
  }
  if (one_place || !rotation.determined) {
    rotation = best(type, orientationMoments(pairs, pairs.size()));
    result.rotation_from_orientations = true;
  }
  result.reference_from_estimate.rotation = Quat(rotation.matrix).normalized();
  result.reference_from_estimate.translation =
      moments.reference_mean - result.scale * (rotation.matrix * moments.estimate_mean);
  return result;
}

Alignment alignFirstPose(AlignmentType type, const PosePairs& pairs, double scale) {
  Alignment result;
  if (type == AlignmentType::None) return result;
  result.scale = type == AlignmentType::Sim3 ? scale : 1.0;
  const Mat3 rotation = best(type, orientationMoments(pairs, 1)).matrix;
  result.reference_from_estimate.rotation = Quat(rotation).normalized();
  result.reference_from_estimate.translation =
      pairs.reference.front().translation - result.scale * (rotation * pairs.estimate.front().translation);
  return result;
}

const char* toString(HeadingBasis basis) { return basis == HeadingBasis::North ? "north" : "start"; }

HeadingBasis headingBasisOf(const std::string& heading_reference) {
  return heading_reference == "true north" ? HeadingBasis::North : HeadingBasis::Start;
}

Alignment alignStarts(HeadingBasis basis, const PosePairs& pairs) {
  if (basis == HeadingBasis::Start) return alignFirstPose(AlignmentType::Yaw, pairs, 1.0);
  Alignment shift;
  shift.reference_from_estimate.translation =
      pairs.reference.front().translation - pairs.estimate.front().translation;
  return shift;
}

std::vector<Rigid3> applyAlignment(const Alignment& alignment, const std::vector<Rigid3>& estimate) {
  std::vector<Rigid3> aligned;
  aligned.reserve(estimate.size());
  for (const Rigid3& pose : estimate) aligned.push_back(alignment.apply(pose));
  return aligned;
}

}  // namespace lodeline

#include "lodeline/trajectory.h"

#include <algorithm>
#include <iterator>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

const ReportedPose& nearest(const std::vector<ReportedPose>& claims, Time time) {
  const auto after = std::lower_bound(claims.begin(), claims.end(), time,
                                      [](const ReportedPose& claim, Time t) { return claim.pose.time < t; });
  if (after == claims.begin()) return *after;
  const auto before = std::prev(after);
  return after == claims.end() || time - before->pose.time < after->pose.time - time ? *before : *after;
}

class AxesSum {
 public:
  void add(const Vec3& error, const Vec3& sigma) {
    const Eigen::Array3d ratio = error.array().abs() / sigma.array().max(1e-12);
    within_ += (ratio < 3.0).cast<double>();
    squared_ += ratio.square();
    ++count_;
  }
  ReportedAxes result() const {
    return {100.0 * within_.matrix() / count_, (squared_ / count_).sqrt().matrix()};
  }

 private:
  Eigen::Array3d within_ = Eigen::Array3d::Zero();
  Eigen::Array3d squared_ = Eigen::Array3d::Zero();
  double count_ = 0.0;
};

}  // namespace

ConsistencyCheck checkConsistency(const ReportedUncertainty& claims, const Trajectory& reference,
                                  const AssociationOptions& association) {
  ConsistencyCheck check;
  check.basis = claims.basis;
  if (claims.poses.empty() || reference.time_base != TimeBase::Stamps) return check;
  Trajectory estimate;
  for (const ReportedPose& claim : claims.poses) estimate.poses.push_back(claim.pose);
  const PosePairs pairs = associate(estimate, withZUp(reference), association);
  const Alignment alignment = alignStarts(claims.basis, pairs);
  const std::vector<Rigid3> poses = applyAlignment(alignment, pairs.estimate);
  const Quat reported_from_reference = alignment.reference_from_estimate.rotation.conjugate();
  const Duration offset = Duration::fromSeconds(association.time_offset_s);
  AxesSum position, rotation;
  for (size_t i = 1; i < poses.size(); ++i) {
    const ReportedPose& claim = nearest(claims.poses, pairs.time[i] - offset);
    position.add(reported_from_reference * (poses[i].translation - pairs.reference[i].translation),
                 claim.position_sigma_m);
    rotation.add(
        reported_from_reference * so3::log(poses[i].rotation * pairs.reference[i].rotation.conjugate()),
        claim.rotation_sigma_rad);
    ++check.poses;
  }
  if (check.poses == 0) return check;
  check.position = position.result();
  check.rotation = rotation.result();
  return check;
}

}  // namespace lodeline

#include "lodeline/frontend/tracking/temporal_tracker.h"

#include <Eigen/LU>

#include "lodeline/geometry/so3.h"

namespace lodeline {

std::optional<PatchWarp> TemporalTracker::predict(const Mat3& current_from_previous_C,
                                                  const PatchWarp& warp) const {
  const auto bearing = camera_->unproject(warp.position.cast<double>());
  if (!bearing) return std::nullopt;
  Mat23 previous_by_ray, current_by_ray;
  if (!camera_->project(*bearing, &previous_by_ray)) return std::nullopt;
  const auto pixel = camera_->project(current_from_previous_C * *bearing, &current_by_ray);
  if (!pixel) return std::nullopt;
  const Mat32 basis = tangentBasis(*bearing);
  const Mat2 current_by_previous =
      current_by_ray * current_from_previous_C * basis * (previous_by_ray * basis).inverse();
  return PatchWarp{pixel->cast<float>(), current_by_previous.cast<float>() * warp.linear};
}

bool TemporalTracker::find(const ImagePyramid& current, const PatchWarp& predicted, Track& track) const {
  // A point that was close to its predicted position will probably be so again, within reach of the fine
  // levels.
  constexpr float kNear_px = 1.0F;
  constexpr int kNearLevel = 1;
  if (track.prediction_error_px && *track.prediction_error_px < kNear_px &&
      findFrom(kNearLevel, current, predicted, track))
    return true;
  return findFrom(options_.coarsest_level, current, predicted, track);
}

bool TemporalTracker::findFrom(int coarsest, const ImagePyramid& current, const PatchWarp& predicted,
                               Track& track) const {
  PatchWarp warp = predicted;
  auto match = track.reference.align(current, coarsest, PatchMotion::Deformation, warp);
  if (match && options_.reference_quality.accepts(*match)) {
    track.warp = warp;
    return true;
  }
  // The appearance of the point has changed: the template of the image before is used, which adds one step of
  // drift.
  warp = {predicted.position, predicted.linear * track.warp.linear.inverse()};
  match = track.current.align(current, coarsest, PatchMotion::Deformation, warp);
  if (!match || !options_.quality.accepts(*match)) return false;
  track.reference = track.current;
  track.warp = warp;
  return true;
}

bool TemporalTracker::returns(const ImagePyramid& previous, const PatchWarp& predicted,
                              const Eigen::Vector2f& previous_position, const Track& track) const {
  // The backward search starts at an offset like that of the forward search, within reach of the fine levels.
  // Without it the check would succeed without any motion of the patch.
  constexpr int kCoarsestLevel = 1;
  constexpr float kReachPx = 1.5F;
  Eigen::Vector2f offset = predicted.position - track.warp.position;
  if (offset.norm() > kReachPx) offset *= kReachPx / offset.norm();
  PatchWarp back{previous_position + offset, Eigen::Matrix2f::Identity()};
  return track.current.align(previous, kCoarsestLevel, PatchMotion::Shift, back) &&
         (back.position - previous_position).norm() <= options_.max_forward_backward_px;
}

bool TemporalTracker::follow(const ImagePyramid& previous, const ImagePyramid& current,
                             const Mat3& current_from_previous_C, Track& track) const {
  const Eigen::Vector2f previous_position = track.warp.position;
  const auto rotated = predict(current_from_previous_C, track.warp);
  if (!rotated) return false;
  PatchWarp predicted = *rotated;
  predicted.position += track.parallax_px;
  if (!find(current, predicted, track)) return false;
  if (!camera_->contains(track.warp.position.cast<double>(), options_.border_px)) return false;

  auto looks = PatchTemplate::extract(current, track.warp.position, options_.coarsest_level + 1);
  if (!looks) return false;
  track.current = std::move(*looks);
  if (!returns(previous, predicted, previous_position, track)) return false;
  track.prediction_error_px = (track.warp.position - predicted.position).norm();
  track.parallax_px = track.warp.position - rotated->position;
  ++track.observations;
  return true;
}

}  // namespace lodeline

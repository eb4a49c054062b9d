#include "lodeline/features/temporal_tracker.h"

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

bool TemporalTracker::find(const ImagePyramid& previous, const ImagePyramid& current,
                           const PatchWarp& predicted, Track& track) const {
  PatchWarp warp = predicted;
  auto match = track.reference.align(current, options_.coarsest_level, warp);
  if (match && options_.quality.accepts(*match)) {
    track.warp = warp;
    return true;
  }
  // The point no longer looks as it first did: carry on from the image before, which costs one step of drift.
  auto renewed = PatchTemplate::extract(previous, {track.warp.position, Eigen::Matrix2f::Identity()},
                                        options_.coarsest_level + 1);
  if (!renewed) return false;
  warp = {predicted.position, predicted.linear * track.warp.linear.inverse()};
  match = renewed->align(current, options_.coarsest_level, warp);
  if (!match || !options_.quality.accepts(*match)) return false;
  track.reference = std::move(*renewed);
  track.warp = warp;
  return true;
}

bool TemporalTracker::returns(const ImagePyramid& previous, const PatchWarp& predicted,
                              const Eigen::Vector2f& previous_position, const Track& track) const {
  // Starting as far off as the forward search did keeps the check from agreeing by standing still.
  constexpr int kCoarsestLevel = 1;
  PatchWarp back{previous_position + (predicted.position - track.warp.position), Eigen::Matrix2f::Identity()};
  return track.current.align(previous, kCoarsestLevel, back) &&
         (back.position - previous_position).norm() <= options_.max_forward_backward_px;
}

bool TemporalTracker::follow(const ImagePyramid& previous, const ImagePyramid& current,
                             const Mat3& current_from_previous_C, Track& track) const {
  const Eigen::Vector2f previous_position = track.warp.position;
  const auto rotated = predict(current_from_previous_C, track.warp);
  if (!rotated) return false;
  PatchWarp predicted = *rotated;
  predicted.position += track.parallax_px;
  if (!find(previous, current, predicted, track)) return false;
  if (!camera_->contains(track.warp.position.cast<double>(), options_.border_px)) return false;

  auto looks = PatchTemplate::extract(current, {track.warp.position, Eigen::Matrix2f::Identity()},
                                      options_.coarsest_level + 1);
  if (!looks) return false;
  track.current = std::move(*looks);
  if (!returns(previous, predicted, previous_position, track)) return false;
  track.parallax_px = track.warp.position - rotated->position;
  ++track.sightings;
  return true;
}

}  // namespace lodeline

#include "lodeline/features/stereo_matcher.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr int kSearchLevel = 2;
constexpr int kFramesBetweenSearches = 4;
/// A match may lie this far on the wrong side of infinity, for calibrations are not perfect.
constexpr double kBeyondInfinityPx = 1.0;

}  // namespace

StereoMatcher::StereoMatcher(std::shared_ptr<const Camera> first, std::shared_ptr<const Camera> second,
                             const StereoMatcherOptions& options)
    : first_(std::move(first)),
      second_(std::move(second)),
      second_from_first_(second_->calibration().body_from_camera.inverse() *
                         first_->calibration().body_from_camera),
      options_(options) {}

std::optional<Vec2> StereoMatcher::projectAt(const Vec3& first_bearing, double inverse_depth_per_m) const {
  return second_->project(second_from_first_.rotation * first_bearing +
                          inverse_depth_per_m * second_from_first_.translation);
}

double StereoMatcher::epipolarErrorPx(const Vec3& first_bearing, const Vec3& second_bearing) const {
  const Vec3 normal = second_from_first_.translation.cross(second_from_first_.rotation * first_bearing);
  const double length = normal.norm();
  if (length < 1e-9) return 0.0;
  return second_->calibration().fx_px * std::abs(normal.dot(second_bearing)) / length;
}

std::optional<double> StereoMatcher::inverseDepth(const Vec3& first_bearing,
                                                  const Vec3& second_bearing) const {
  // second x (R first + inverse_depth t) = 0, in the least-squares sense.
  const Vec3 a = second_bearing.cross(second_from_first_.translation);
  const Vec3 b = second_bearing.cross(second_from_first_.rotation * first_bearing);
  const double parallax2 = a.squaredNorm();
  if (parallax2 < 1e-12) return std::nullopt;
  return -a.dot(b) / parallax2;
}

std::optional<PatchWarp> StereoMatcher::search(const ImagePyramid& second, const Vec3& first_bearing,
                                               const PatchTemplate& looks) const {
  const double nearest_per_m = 1.0 / options_.min_depth_m;
  const auto far_end = projectAt(first_bearing, 0.0);
  if (!far_end) return std::nullopt;
  const auto near_end = projectAt(first_bearing, nearest_per_m);
  const double length_px = near_end ? (*near_end - *far_end).norm() : 200.0;
  const int steps = std::clamp(static_cast<int>(length_px / (1 << kSearchLevel)), 1, 200);

  std::optional<PatchWarp> best;
  float best_correlation = 0.0F;
  for (int i = 0; i <= steps; ++i) {
    const auto pixel = projectAt(first_bearing, nearest_per_m * i / steps);
    if (!pixel) continue;
    const PatchWarp candidate{pixel->cast<float>(), Eigen::Matrix2f::Identity()};
    const auto correlation = looks.correlate(second, kSearchLevel, candidate);
    if (!correlation || *correlation <= best_correlation) continue;
    best_correlation = *correlation;
    best = candidate;
  }
  return best;
}

bool StereoMatcher::returns(const ImagePyramid& first, const ImagePyramid& second, const PatchWarp& match,
                            const Track& track) const {
  const auto looks = PatchTemplate::extract(second, match.position, 2);
  if (!looks) return false;
  PatchWarp back{track.warp.position + Eigen::Vector2f(1.0F, 0.5F), match.linear.inverse()};
  return looks->align(first, 1, PatchMotion::Shift, back) &&
         (back.position - track.warp.position).norm() <= options_.max_left_right_px;
}

std::optional<PatchWarp> StereoMatcher::match(const ImagePyramid& first, const ImagePyramid& second,
                                              const std::optional<PatchWarp>& hint, Track& track) const {
  const auto first_bearing = first_->unproject(track.warp.position.cast<double>());
  if (!first_bearing) return std::nullopt;

  std::optional<PatchWarp> warp;
  int coarsest = options_.coarsest_level;
  // A point that is not seen in the other camera would be searched for in vain in every frame.
  const bool search_again = !hint && (track.id + track.sightings) % kFramesBetweenSearches == 0;
  if (track.inverse_depth_per_m && !search_again) {
    const auto expected = projectAt(*first_bearing, *track.inverse_depth_per_m);
    if (expected) warp = PatchWarp{expected->cast<float>(), Eigen::Matrix2f::Identity()};
    if (warp && hint) warp->linear = hint->linear;
  } else if (track.sightings == 1 || search_again) {
    warp = search(second, *first_bearing, track.current);
    coarsest = kSearchLevel;
  }
  if (!warp) return std::nullopt;
  const auto found = track.current.align(second, coarsest, PatchMotion::Deformation, *warp);
  if (!found || !options_.quality.accepts(*found)) return std::nullopt;
  if (!second_->contains(warp->position.cast<double>(), options_.border_px)) return std::nullopt;

  const auto second_bearing = second_->unproject(warp->position.cast<double>());
  if (!second_bearing) return std::nullopt;
  if (epipolarErrorPx(*first_bearing, *second_bearing) > options_.max_epipolar_px) return std::nullopt;
  const auto inverse_depth = inverseDepth(*first_bearing, *second_bearing);
  if (!inverse_depth) return std::nullopt;
  const double farthest_per_m =
      -kBeyondInfinityPx / (second_->calibration().fx_px * second_from_first_.translation.norm());
  if (*inverse_depth < farthest_per_m || *inverse_depth > 1.0 / options_.min_depth_m) return std::nullopt;
  if (!returns(first, second, *warp, track)) return std::nullopt;
  track.inverse_depth_per_m = std::max(0.0, *inverse_depth);
  return warp;
}

}  // namespace lodeline

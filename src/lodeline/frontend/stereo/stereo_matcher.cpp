#include "lodeline/frontend/stereo/stereo_matcher.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr int kSearchLevel = 2;
constexpr int kFramesBetweenSearches = 4;
/// Tolerance beyond infinity for a match, because calibrations are not perfect.
constexpr double kBeyondInfinityPx = 1.0;
constexpr double kLimit_rad = 0.25 * kDegree;

Rigid3 relativePose(const Camera& first, const Camera& second) {
  return second.calibration().body_from_camera.inverse() * first.calibration().body_from_camera;
}

}  // namespace

StereoMatcher::StereoMatcher(std::shared_ptr<const Camera> first, std::shared_ptr<const Camera> second,
                             const StereoMatcherOptions& options)
    : first_(std::move(first)),
      second_(std::move(second)),
      options_(options),
      focal_length_px_(second_->focalLengthsOnAxis_px().x()),
      limit_px_(std::max(options.max_epipolar_px, kLimit_rad * focal_length_px_)),
      rotation_(relativePose(*first_, *second_), focal_length_px_, limit_px_),
      second_from_first_by_file_(relativePose(*first_, *second_)),
      second_from_first_(second_from_first_by_file_) {}

Rigid3 StereoMatcher::imageSecondFromFirst() const {
  return frame_from_image_C_ ? frame_from_image_C_->inverse() * second_from_first_by_file_
                             : second_from_first_by_file_;
}

void StereoMatcher::place() {
  const Rigid3 by_file = imageSecondFromFirst();
  const Quat turn = so3::exp(rotation_.turn());
  second_from_first_ = Rigid3(turn * by_file.rotation, turn * by_file.translation);
}

void StereoMatcher::setMotion(const RigMotion& motion, size_t camera) {
  const Rigid3& body_from_second = second_->calibration().body_from_camera;
  const Mat3 second_from_body = body_from_second.rotation.conjugate().toRotationMatrix();
  rate_C_ = second_from_body * motion.rate_B;
  velocity_C_ = second_from_body * (motion.velocity_B + motion.rate_B.cross(body_from_second.translation));
  const bool was_moved = frame_from_image_C_.has_value();
  frame_from_image_C_.reset();
  if (!motion.frame_from_image_B.empty()) {
    frame_from_image_C_ = body_from_second.inverse() * motion.frame_from_image_B[camera] * body_from_second;
  }
  if (was_moved || frame_from_image_C_) place();
}

Vec3 StereoMatcher::rayAtFrame(const RayPair& rays, double inverse_depth_per_m) const {
  if (!frame_from_image_C_) return rays.second;
  // The point times its inverse depth, which is also valid for points at infinity.
  const Rigid3 between = rays.betweenOrigins(second_from_first_);
  const Vec3 from_origin_C = between.rotation * rays.first + inverse_depth_per_m * between.translation;
  const Vec3 origin_C = inverse_depth_per_m * rays.second_origin;
  return (frame_from_image_C_->rotation * (origin_C + from_origin_C.norm() * rays.second) +
          inverse_depth_per_m * frame_from_image_C_->translation - origin_C)
      .normalized();
}

std::optional<Vec2> StereoMatcher::projectAt(const ViewRay& first, double inverse_depth_per_m) const {
  const Vec3 homogeneous_C = first.direction_C + inverse_depth_per_m * first.origin_C;
  return second_->projectHomogeneous(
      second_from_first_.rotation * homogeneous_C + inverse_depth_per_m * second_from_first_.translation,
      inverse_depth_per_m);
}

double StereoMatcher::epipolarErrorPx(const RayPair& rays) const {
  const std::optional<Vec3> normal = epipolarNormal(rays.betweenOrigins(second_from_first_), rays.first);
  return normal ? focal_length_px_ * std::abs(normal->dot(rays.second)) : 0.0;
}

std::optional<double> StereoMatcher::inverseDepth(const RayPair& rays) const {
  // Solves second x (R first + inverse_depth t) = 0 by least squares.
  const Rigid3 between = rays.betweenOrigins(second_from_first_);
  const Vec3 a = rays.second.cross(between.translation);
  const Vec3 b = rays.second.cross(between.rotation * rays.first);
  const double parallax2 = a.squaredNorm();
  if (parallax2 < 1e-12) return std::nullopt;
  return -a.dot(b) / parallax2;
}

std::optional<PatchWarp> StereoMatcher::search(const ImagePyramid& second, const ViewRay& first,
                                               const PatchTemplate& looks) const {
  const double nearest_per_m = 1.0 / options_.min_depth_m;
  const auto far_end = projectAt(first, 0.0);
  if (!far_end) return std::nullopt;
  const auto near_end = projectAt(first, nearest_per_m);
  const double length_px = near_end ? (*near_end - *far_end).norm() : 200.0;
  const int steps = std::clamp(static_cast<int>(length_px / (1 << kSearchLevel)), 1, 200);

  std::optional<PatchWarp> best;
  float best_correlation = 0.0F;
  for (int i = 0; i <= steps; ++i) {
    const auto pixel = projectAt(first, nearest_per_m * i / steps);
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
  const auto looks = PatchTemplate::extract(second, match.position, 2, PatchMotion::Shift);
  if (!looks) return false;
  PatchWarp back{track.warp.position + Eigen::Vector2f(1.0F, 0.5F), match.linear.inverse()};
  return looks->align(first, 1, PatchMotion::Shift, back) &&
         (back.position - track.warp.position).norm() <= options_.max_left_right_px;
}

std::optional<PatchWarp> StereoMatcher::align(const ImagePyramid& second, const PatchTemplate& looks,
                                              const PatchWarp& expected, bool is_near, int coarsest) const {
  constexpr int kNearLevel = 1;
  const auto from = [&](int level) -> std::optional<PatchWarp> {
    PatchWarp warp = expected;
    const auto found = looks.align(second, level, PatchMotion::Deformation, warp);
    return found && options_.quality.accepts(*found) ? std::optional(warp) : std::nullopt;
  };
  const auto near = is_near ? from(kNearLevel) : std::nullopt;
  return near ? near : from(coarsest);
}

std::optional<StereoCandidate> StereoMatcher::find(const ImagePyramid& first, const ImagePyramid& second,
                                                   const std::optional<PatchWarp>& hint,
                                                   const Track& track) const {
  auto first_ray = first_->viewRay(track.warp.position.cast<double>());
  if (!first_ray) return std::nullopt;
  first_ray = first_ray->fromNearestPoint();

  std::optional<PatchWarp> warp;
  int coarsest = options_.coarsest_level;
  bool is_near = false;
  // Otherwise a point that the other camera does not observe would be searched in every frame.
  const bool search_again = !hint && (track.id + track.observations) % kFramesBetweenSearches == 0;
  if (track.inverse_depth_per_m && !search_again) {
    const auto expected = projectAt(*first_ray, *track.inverse_depth_per_m);
    if (expected) warp = PatchWarp{expected->cast<float>(), Eigen::Matrix2f::Identity()};
    if (warp && hint) warp->linear = hint->linear;
    is_near = hint.has_value();
  } else if (track.observations == 1 || search_again) {
    warp = search(second, *first_ray, track.current);
    coarsest = kSearchLevel;
  }
  if (!warp) return std::nullopt;
  warp = align(second, track.current, *warp, is_near, coarsest);
  if (!warp) return std::nullopt;
  if (!second_->contains(warp->position.cast<double>(), options_.border_px)) return std::nullopt;

  const auto second_ray = second_->viewRay(warp->position.cast<double>());
  if (!second_ray) return std::nullopt;
  const RayPair rays = rayPair(*first_ray, *second_ray);
  const double widest_px =
      options_.learn_rotation ? std::max(limit_px_, options_.max_rotation_rad * focal_length_px_) : limit_px_;
  if (epipolarErrorPx(rays) > widest_px || !returns(first, second, *warp, track)) return std::nullopt;
  return StereoCandidate{*warp, rays};
}

void StereoMatcher::learn(const std::vector<RayPair>& candidates) {
  delay_.add(candidates, second_from_first_, focal_length_px_, rate_C_, velocity_C_);
  if (!options_.learn_rotation) return;
  rotation_.add(candidates, imageSecondFromFirst());
  place();
}

std::optional<double> StereoMatcher::accept(const RayPair& candidate) const {
  if (epipolarErrorPx(candidate) > limit_px_) return std::nullopt;
  const auto inverse_depth = inverseDepth(candidate);
  if (!inverse_depth) return std::nullopt;
  const double farthest_per_m =
      -kBeyondInfinityPx / (focal_length_px_ * second_from_first_.translation.norm());
  if (*inverse_depth < farthest_per_m || *inverse_depth > 1.0 / options_.min_depth_m) return std::nullopt;
  return std::max(0.0, *inverse_depth);
}

Vec3 StereoMatcher::rotationCorrection() const {
  return -(second_from_first_by_file_.rotation.conjugate() * rotation_.turn());
}

}  // namespace lodeline

#include "lodeline/mapping/control/tags/tag_observer.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lodeline/board/calibration_board.h"
#include "lodeline/diagnostics.h"
#include "lodeline/mapping/control/tags/tag_pose.h"

namespace lodeline {
namespace {

Vec2 centreOf(const FoundTag& tag) {
  return 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
}

/// Whether two detections are of one square: both kinds of border may decode it, one of them with wrong bits.
bool areSameSquare(const FoundTag& one, const FoundTag& other) {
  return (centreOf(one) - centreOf(other)).norm() < 0.25 * one.edge_px();
}

}  // namespace

void TagOptions::check() const {
  const auto require = [](bool is_good, const char* what) {
    if (!is_good) throw UsageError(what);
  };
  require(size_m >= 0.0 && std::isfinite(size_m), "the size of tags must not be negative");
  for (const auto& [tag, size] : sizes_m)
    require(size > 0.0 && std::isfinite(size), "the size of a tag must be positive");
  require(size_sigma_share >= 0.0 && size_sigma_share < 1.0, "the sigma of the size of tags must be below 1");
  require(corner_sigma_px > 0.0, "the sigma of corners of tags must be positive");
  require(most_wrong_bits >= 0 && most_wrong_bits <= 2, "the code of tags corrects 0 to 2 bits");
  require(least_edge_px > 0.0 && most_rms_sigmas > 0.0, "the limits of tags must be positive");
}

TagObserver::TagObserver(std::shared_ptr<const Camera> camera, const Rigid3& body_from_camera,
                         int camera_index, const TagOptions& options)
    : camera_(std::move(camera)),
      body_from_camera_(body_from_camera),
      camera_index_(camera_index),
      options_(options) {
  options_.check();
}

std::vector<TagObservation> TagObserver::observe(const cv::Mat& image) const {
  std::vector<FoundTag> tags = detector_.find(image, CalibrationBoard::kFamilySize);
  std::erase_if(tags, [&](const FoundTag& tag) {
    return tag.wrong_bits > options_.most_wrong_bits || tag.edge_px() < options_.least_edge_px;
  });
  std::stable_sort(tags.begin(), tags.end(), [](const FoundTag& a, const FoundTag& b) {
    return std::tuple(a.id, a.wrong_bits, -a.margin) < std::tuple(b.id, b.wrong_bits, -b.margin);
  });
  std::vector<TagObservation> observations;
  for (auto tag = tags.begin(); tag != tags.end();) {
    const auto end =
        std::find_if(tag, tags.end(), [&](const FoundTag& other) { return other.id != tag->id; });
    if (std::all_of(tag, end, [&](const FoundTag& other) { return areSameSquare(*tag, other); })) {
      if (auto one = observation(*tag)) observations.push_back(std::move(*one));
    }
    tag = end;
  }
  return observations;
}

std::optional<BodyRay> TagObserver::rayOf(const Vec2& pixel) const {
  const auto line = camera_->viewRay(pixel);
  // The angle of a pixel, from its neighbours.
  const auto right = camera_->unproject(pixel + Vec2(0.5, 0.0)),
             left = camera_->unproject(pixel - Vec2(0.5, 0.0));
  const auto below = camera_->unproject(pixel + Vec2(0.0, 0.5)),
             above = camera_->unproject(pixel - Vec2(0.0, 0.5));
  if (!line || !right || !left || !below || !above) return std::nullopt;
  const ViewRay nearest = line->fromNearestPoint();
  BodyRay ray;
  ray.camera = camera_index_;
  ray.pixel = pixel;
  ray.origin_B = body_from_camera_ * nearest.origin_C;
  ray.bearing_B = body_from_camera_.rotation * nearest.direction_C;
  ray.sigma_rad = options_.corner_sigma_px *
                  std::sqrt(0.5 * ((*right - *left).squaredNorm() + (*below - *above).squaredNorm()));
  return ray;
}

std::optional<TagObservation> TagObserver::observation(const FoundTag& tag) const {
  if (tag.wrong_bits > options_.most_wrong_bits || tag.edge_px() < options_.least_edge_px)
    return std::nullopt;
  TagObservation observation;
  observation.tag = tag.id;
  for (size_t k = 0; k < 4; ++k) {
    const auto ray = rayOf(tag.corners[k]);
    if (!ray) return std::nullopt;
    observation.corners[k] = *ray;
  }
  const auto stated = options_.sizes_m.find(tag.id);
  const double size_m = stated != options_.sizes_m.end() ? stated->second : options_.size_m;
  if (size_m == 0.0) return observation;
  const auto pose = tagPose(observation.corners, size_m);
  if (!pose || pose->rms_sigmas > options_.most_rms_sigmas) return std::nullopt;
  observation.centre_B = pose->centre_B;
  // An error of the size scales the distance from the camera.
  const Vec3 along = options_.size_sigma_share * (pose->centre_B.position - observation.corners[0].origin_B);
  observation.centre_B->covariance += along * along.transpose();
  return observation;
}

}  // namespace lodeline

#include "lodeline/mapping/recognition/keyframe_describer.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/detection/corner_detector.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/mapping/recognition/upright_descriptors.h"
#include "lodeline/util/settings/option_check.h"

namespace lodeline {
namespace {

/// Sine of the angle to the vertical below which its projection says nothing certain: an error of the
/// attitude by 1 degree would turn it by more than 3 degrees.
constexpr double kNearlyVertical = 0.3;

/// Direction in which the vertical appears at a pixel, clockwise from the image's x axis; empty where the ray
/// is nearly vertical. `up_C`: unit, in the camera's axes.
std::optional<double> upInImage(const Camera& camera, const Vec2& pixel, const Vec3& up_C) {
  const auto ray = camera.unproject(pixel);
  if (!ray || ray->cross(up_C).norm() < kNearlyVertical) return std::nullopt;
  Mat23 pixel_by_point;
  if (!camera.project(*ray, &pixel_by_point)) return std::nullopt;
  const Vec2 up = pixel_by_point * up_C;
  return std::atan2(up.y(), up.x());
}

/// Tracked points with their rays and positions, in the order of the tracks.
std::vector<MapFeature> trackedFeatures(const FrameTracks& tracks, const FrameGeometry& geometry) {
  std::vector<MapFeature> features;
  for (const FeatureObservation& seen : tracks.observations) {
    const bool is_further = !features.empty() && features.back().track == seen.track;
    if (!is_further && seen.camera != 0) continue;
    const auto ray = geometry.rayOf(seen.camera, seen.pixel, seen.sigma_px);
    if (!ray) continue;
    if (!is_further) {
      MapFeature& feature = features.emplace_back();
      feature.track = seen.track;
      if (const TrackPoint* point = geometry.find(seen.track)) {
        feature.point_B = point->point_B;
        feature.distance_sigma_m = point->distance_sigma_m;
      }
    }
    features.back().rays.push_back(*ray);
  }
  return features;
}

/// Adds corners that are not tracked.
void addCorners(const cv::Mat& image, const cv::Mat& visible, const FrameGeometry& geometry,
                const KeyframeDescriberOptions& options, std::vector<MapFeature>* features) {
  // Half the usual side of a cell would place twice as many points; closer ones share most of their patch.
  constexpr double kDistance_px = 8.0;
  constexpr int kLevels = 2;
  const int missing = options.features - static_cast<int>(features->size());
  if (missing <= 0) return;
  std::vector<Eigen::Vector2f> occupied;
  for (const MapFeature& feature : *features) occupied.push_back(feature.rays.front().pixel.cast<float>());
  const CornerDetector detector({.max_tracks = options.features, .min_distance_px = kDistance_px});
  int added = 0;
  for (const Eigen::Vector2f& pixel : detector.detect(ImagePyramid(image, kLevels), visible, occupied)) {
    if (added == missing) break;
    const auto ray = geometry.rayOf(0, pixel.cast<double>(), options.corner_sigma_px);
    if (!ray) continue;
    features->emplace_back().rays.push_back(*ray);
    ++added;
  }
}

/// Describes all features; those too near to the edge of the image are dropped.
void addDescriptors(const cv::Mat& image, const Camera& camera, const Vec3& up_C,
                    std::vector<MapFeature>* features) {
  std::vector<PointToDescribe> points;
  for (const MapFeature& feature : *features) {
    const Vec2& pixel = feature.rays.front().pixel;
    points.push_back({pixel, upInImage(camera, pixel, up_C)});
  }
  const auto descriptors = uprightDescriptors(image, points);
  std::vector<MapFeature> described;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    if (!descriptors[i]) continue;
    described.push_back(std::move((*features)[i]));
    described.back().descriptor = *descriptors[i];
  }
  *features = std::move(described);
}

/// The values of a keyframe beside its features.
MapKeyframe keyframeOf(const FrameEstimate& estimate) {
  MapKeyframe keyframe;
  keyframe.time = estimate.time;
  keyframe.odom_from_body = estimate.state.world_from_body;
  keyframe.covariance = estimate.covariance.topLeftCorner<6, 6>();
  const MagnetometerEstimate& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  if (magnetometer.north_from_world_rad) {
    keyframe.north_from_odom_rad = *magnetometer.north_from_world_rad;
    keyframe.heading_sigma_rad = std::hypot(magnetometer.heading_sigma_rad, magnetometer.axes_sigma_rad);
  }
  if (const auto& gauge = estimate.sensors.of<DepthEstimate>().gauge) {
    // The gauge's readings give the height of the body, whose sigma is therefore that of the depth.
    keyframe.depth_m = ScalarPrior{gauge->body_depth_m, std::sqrt(estimate.covariance(2, 2))};
  }
  return keyframe;
}

}  // namespace

void KeyframeDescriberOptions::check() const {
  OptionCheck("keyframe_describer")
      .atLeast("features", features, 1)
      .positive("corner_sigma_px", corner_sigma_px);
}

KeyframeDescriber::KeyframeDescriber(const Rig& rig, const KeyframeDescriberOptions& options)
    : options_(options) {
  options.check();
  if (rig.cameras.empty()) throw InputError("keyframes of a map need a camera, and the rig has none");
  for (const CameraCalibration& calibration : rig.cameras) cameras_.push_back(makeCamera(calibration));
  mask_ = loadMask(rig.cameras.front());
}

MapKeyframe KeyframeDescriber::describe(const cv::Mat& image, const FrameTracks& tracks,
                                        const FrameEstimate& estimate, const Estimator& estimator,
                                        const cv::Mat& visible) const {
  return describe(image, tracks, estimate, frameGeometry(estimator, cameras_, tracks), visible);
}

MapKeyframe KeyframeDescriber::describe(const cv::Mat& image, const FrameTracks& tracks,
                                        const FrameEstimate& estimate, const FrameGeometry& geometry,
                                        const cv::Mat& visible) const {
  const Camera& camera = *cameras_.front();
  const CameraCalibration& calibration = camera.calibration();
  if (image.type() != CV_8UC1 || image.cols != calibration.width_px || image.rows != calibration.height_px) {
    throw InputError(fmt::format("image at {} ns: not an 8-bit grey image of {} x {} px, as camera '{}' has",
                                 tracks.time.nanoseconds(), calibration.width_px, calibration.height_px,
                                 calibration.name));
  }
  cv::Mat free = mask_;
  if (!visible.empty()) free = mask_.empty() ? visible : cv::Mat(mask_ & visible);
  MapKeyframe keyframe = keyframeOf(estimate);
  keyframe.features = trackedFeatures(tracks, geometry);
  addCorners(image, free, geometry, options_, &keyframe.features);
  const Quat odom_from_camera =
      estimate.state.world_from_body.rotation * geometry.body_from_cameras.front().rotation;
  addDescriptors(image, camera, odom_from_camera.conjugate() * Vec3::UnitZ(), &keyframe.features);
  return keyframe;
}

}  // namespace lodeline

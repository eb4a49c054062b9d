#include "lodeline/mapping/recognition/keyframe_describer.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/mapping/recognition/keypoints/blob_detector.h"
#include "lodeline/mapping/recognition/keypoints/stereo_points.h"
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


/// Distance expected along a ray: that of the nearest tracked points, in the image.
double expectedDistance_m(const std::vector<MapFeature>& tracked, const Vec2& pixel) {
  double weights = 0.0, inverse = 0.0;
  for (const MapFeature& feature : tracked) {
    if (!feature.point_B || feature.track < 0) continue;
    const double apart2 = (feature.rays.front().pixel - pixel).squaredNorm();
    const double weight = 1.0 / ((apart2 + 25.0) * (apart2 + 25.0));
    weights += weight;
    inverse += weight / (*feature.point_B - feature.rays.front().origin_B).norm();
  }
  return weights > 0.0 ? weights / inverse : 2.0;
}

/// Adds blobs that are not tracked.
void addBlobs(const std::vector<cv::Mat>& images, const EvenedImage& evened, const cv::Mat& visible, const FrameGeometry& geometry,
                const KeyframeDescriberOptions& options, std::vector<MapFeature>* features, std::vector<double>* sizes) {
  static const double kSigma = env("R_KSIGMA", 1.0);
  std::vector<BodyRay> rays;
  std::vector<double> distances_m, new_sizes;
  for (const Keypoint& point : detectBlobs(evened, visible, options.features)) {
    const auto ray = geometry.rayOf(0, point.pixel, kSigma);
    if (!ray) continue;
    rays.push_back(*ray);
    new_sizes.push_back(point.size_px);
    distances_m.push_back(expectedDistance_m(*features, point.pixel));
  }
  std::vector<MapFeature> added;
  for (const BodyRay& ray : rays) added.emplace_back().rays.push_back(ray);
  for (size_t camera = 1; camera < images.size(); ++camera) {
    if (images[camera].empty()) continue;
    const auto found = secondRays(images[0], images[camera], static_cast<int>(camera), geometry, rays, distances_m, kSigma);
    for (size_t i = 0; i < rays.size(); ++i)
      if (found[i]) added[i].rays.push_back(*found[i]);
  }
  for (size_t i = 0; i < added.size(); ++i) {
    if (added[i].rays.size() > 1) {
      if (const auto point = pointOfRays(-1, added[i].rays)) {
        added[i].point_B = point->point_B;
        added[i].distance_sigma_m = point->distance_sigma_m;
      }
    }
    features->push_back(std::move(added[i]));
    sizes->push_back(new_sizes[i]);
  }
}

/// Describes all features; those too near to the edge of the image are dropped.
void addDescriptors(const EvenedImage& image, const Camera& camera, const Vec3& up_C,
                    std::vector<MapFeature>* features, const std::vector<double>& sizes) {
  static const double kFixed = env("R_FIXED", 0.0), kMetric = env("R_METRIC", 0.0);
  std::vector<PointToDescribe> points;
  size_t i = 0;
  for (const MapFeature& feature : *features) {
    const Vec2& pixel = feature.rays.front().pixel;
    double size = sizes[i++];
    if (kFixed > 0) size = kFixed;
    if (kMetric > 0) {
      const double d = feature.point_B ? (*feature.point_B - feature.rays.front().origin_B).norm() : expectedDistance_m(*features, pixel);
      size = std::clamp(kMetric * camera.focalLengthsOnAxis_px().mean() * image.scale / d, 3.2, 16.0);
    }
    points.push_back({pixel, size, upInImage(camera, pixel, up_C)});
  }
  const auto descriptors = uprightDescriptors(image, points);
  std::vector<MapFeature> described;
  for (size_t k = 0; k < descriptors.size(); ++k) {
    if (!descriptors[k]) continue;
    described.push_back(std::move((*features)[k]));
    described.back().descriptor = *descriptors[k];
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

MapKeyframe KeyframeDescriber::describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks,
                                        const FrameEstimate& estimate, const Estimator& estimator,
                                        const cv::Mat& visible) const {
  return describe(images, tracks, estimate, frameGeometry(estimator, cameras_, tracks), visible);
}

MapKeyframe KeyframeDescriber::describe(const std::vector<cv::Mat>& images, const FrameTracks& tracks,
                                        const FrameEstimate& estimate, const FrameGeometry& geometry,
                                        const cv::Mat& visible) const {
  const Camera& camera = *cameras_.front();
  const cv::Mat& image = images.front();
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
  std::vector<double> sizes(keyframe.features.size(), env("R_TSIZE", 6.4));
  if (env("R_NOTRACKS", 0) > 0) { sizes.clear(); }
  const EvenedImage evened(image, camera);
  addBlobs(images, evened, free, geometry, options_, &keyframe.features, &sizes);
  const Quat odom_from_camera =
      estimate.state.world_from_body.rotation * geometry.body_from_cameras.front().rotation;
  addDescriptors(evened, camera, odom_from_camera.conjugate() * Vec3::UnitZ(), &keyframe.features, sizes);
  return keyframe;
}

}  // namespace lodeline

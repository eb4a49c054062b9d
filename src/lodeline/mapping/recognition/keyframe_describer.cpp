#include "lodeline/mapping/recognition/keyframe_describer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/magnetometer/field/field_reading.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/mapping/recognition/keypoints/blob_detector.h"
#include "lodeline/mapping/recognition/keypoints/scene_distance.h"
#include "lodeline/mapping/recognition/stereo_points.h"
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

/// Standard deviation with which the patch around a pixel is found in another image of the same time, px. A
/// blob is found less accurately at another visit.
constexpr double kStereoSigma_px = 0.6;

/// Features at the blobs of the image, with rays of all cameras that see them, and positions.
std::vector<MapFeature> blobFeatures(const EvenedImage& evened, const std::vector<cv::Mat>& images,
                                     const cv::Mat& visible, const FrameGeometry& geometry,
                                     const SceneDistance& scene, const KeyframeDescriberOptions& options) {
  std::vector<ExpectedPoint> expected;
  std::vector<MapFeature> features;
  for (const Vec2& pixel : detectBlobs(evened, visible, options.features)) {
    const auto ray = geometry.rayOf(0, pixel, kStereoSigma_px);
    if (!ray) continue;
    expected.push_back({*ray, scene.at(pixel).distance_m});
    features.emplace_back().rays.push_back(*ray);
  }
  for (size_t camera = 1; camera < images.size(); ++camera) {
    if (images[camera].empty()) continue;
    const auto rays = raysOfFurtherCamera(images.front(), images[camera], static_cast<int>(camera), geometry,
                                          expected, kStereoSigma_px);
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays[i]) features[i].rays.push_back(*rays[i]);
  }
  return features;
}

/// Sets the position of a blob: where its rays cross or, where there is but one image, on the surface of the
/// tracked points around it.
void place(const SceneDistance& scene, bool is_single_image, MapFeature* feature) {
  if (feature->rays.size() > 1) {
    if (const auto point = pointOfRays(-1, feature->rays)) {
      feature->point_B = point->point_B;
      feature->distance_sigma_m = point->distance_sigma_m;
    }
  }
  if (!is_single_image) return;
  const BodyRay& ray = feature->rays.front();
  const ExpectedDistance expected = scene.at(ray.pixel);
  if (!expected.relative_sigma) return;
  feature->point_B = ray.origin_B + expected.distance_m * ray.bearing_B;
  feature->distance_sigma_m = *expected.relative_sigma * expected.distance_m;
}

/// Adds blobs, and keeps as many features as the keyframe may have: those with a position first.
void addBlobs(std::vector<MapFeature> blobs, int most, std::vector<MapFeature>* features) {
  features->insert(features->end(), std::make_move_iterator(blobs.begin()),
                   std::make_move_iterator(blobs.end()));
  std::vector<size_t> order(features->size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_partition(order.begin(), order.end(),
                        [&](size_t i) { return (*features)[i].point_B.has_value(); });
  order.resize(std::min(order.size(), static_cast<size_t>(most)));
  // Tracks rise: the map file stores differences of their numbers.
  std::sort(order.begin(), order.end());
  std::vector<MapFeature> kept;
  for (const size_t i : order) kept.push_back(std::move((*features)[i]));
  *features = std::move(kept);
}

/// Describes all features, in patches of one size on the rock; those too near to the edge of the image are
/// dropped.
void addDescriptors(const EvenedImage& image, const Camera& camera, const Vec3& up_C,
                    const SceneDistance& scene, std::vector<MapFeature>* features) {
  // The patch is twelve sigmas wide: a quarter of a metre.
  constexpr double kSigma_m = 0.02, kFinest_px = 1.6, kCoarsest_px = 8.0;
  std::vector<PointToDescribe> points;
  for (const MapFeature& feature : *features) {
    const BodyRay& ray = feature.rays.front();
    const double distance_m =
        feature.point_B ? (*feature.point_B - ray.origin_B).norm() : scene.at(ray.pixel).distance_m;
    const double sigma_px = std::clamp(kSigma_m * image.focal_px / distance_m, kFinest_px, kCoarsest_px);
    points.push_back({ray.pixel, sigma_px, upInImage(camera, ray.pixel, up_C)});
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

/// The magnetic field at the estimator's newest frame.
std::optional<KeyframeField> fieldOf(const Estimator& estimator) {
  if (!estimator.initialized()) return std::nullopt;
  const auto* reading = estimator.window().newest().measurements.find<FieldReading>();
  if (reading == nullptr) return std::nullopt;
  return KeyframeField{reading->field_B, reading->sigma_T};
}

}  // namespace

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
    const double by_density_m = gauge->density_ratio_sigma / gauge->density_ratio * gauge->body_depth_m;
    keyframe.depth_m =
        ScalarPrior{gauge->body_depth_m, std::hypot(std::sqrt(estimate.covariance(2, 2)), by_density_m)};
  }
  return keyframe;
}

void KeyframeDescriberOptions::check() const {
  OptionCheck("keyframe_describer").atLeast("features", features, 1).positive("blob_sigma_px", blob_sigma_px);
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
  MapKeyframe keyframe =
      describe(images, tracks, estimate, frameGeometry(estimator, cameras_, tracks), visible);
  keyframe.field = fieldOf(estimator);
  return keyframe;
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
  const SceneDistance scene(keyframe.features, camera.focalLengthsOnAxis_px().mean());
  const EvenedImage evened(image, camera);
  std::vector<MapFeature> blobs = blobFeatures(evened, images, free, geometry, scene, options_);
  const auto count =
      std::count_if(images.begin(), images.end(), [](const cv::Mat& taken) { return !taken.empty(); });
  const double ray_sigma = options_.blob_sigma_px / (evened.scale * kStereoSigma_px);
  for (MapFeature& blob : blobs) {
    place(scene, count == 1, &blob);
    blob.rays.front().sigma_rad *= ray_sigma;
  }
  addBlobs(std::move(blobs), options_.features, &keyframe.features);
  const Quat odom_from_camera =
      estimate.state.world_from_body.rotation * geometry.body_from_cameras.front().rotation;
  addDescriptors(evened, camera, odom_from_camera.conjugate() * Vec3::UnitZ(), scene, &keyframe.features);
  return keyframe;
}

}  // namespace lodeline

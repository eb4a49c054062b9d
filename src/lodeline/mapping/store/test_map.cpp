#include "lodeline/mapping/store/test_map.h"

#include <cmath>

namespace lodeline::test {
namespace {

constexpr double kFocal_px = 458.0;
constexpr double kSigma_rad = 1e-3;

Vec3 noiseVector(std::mt19937* random) {
  std::normal_distribution<double> normal;
  const double x = normal(*random), y = normal(*random);
  return Vec3(x, y, normal(*random));
}

/// The ray of camera 0 or 1 to a point in camera axes (z forward), which are those of the body here.
BodyRay rayTo(const Vec3& point, int camera, double port_mm, std::mt19937* random) {
  BodyRay ray;
  ray.camera = camera;
  const Vec3 centre(0.11 * camera, 0.0, 0.0);
  const Vec3 exact = (point - centre).normalized();
  ray.bearing_B = (exact + kSigma_rad * noiseVector(random)).normalized();
  ray.pixel = kFocal_px * ray.bearing_B.head<2>() / ray.bearing_B.z() + Vec2(376.0, 240.0);
  const double tangent = ray.bearing_B.head<2>().norm() / ray.bearing_B.z();
  const Vec3 shift = 1e-3 * port_mm * tangent * tangent * Vec3::UnitZ();
  ray.origin_B = centre + shift - shift.dot(ray.bearing_B) * ray.bearing_B;
  ray.sigma_rad = kSigma_rad;
  return ray;
}

}  // namespace

std::vector<MapFeature> stereoFeatures(int count, double port_mm, std::mt19937* random) {
  std::uniform_real_distribution<double> share;
  std::vector<MapFeature> features;
  TrackId last_track = 100000;
  for (int i = 0; i < count; ++i) {
    MapFeature feature;
    last_track += 1 + static_cast<TrackId>(25 * share(*random));
    if (i < count * 4 / 5) feature.track = last_track;
    for (uint64_t& word : feature.descriptor.bits)
      word = static_cast<uint64_t>((*random)()) << 32 | static_cast<uint64_t>((*random)());
    const double u = 750.0 * share(*random), v = 478.0 * share(*random);
    const double depth_m = 0.5 * std::exp(3.0 * share(*random));
    const Vec3 point = depth_m * Vec3((u - 376.0) / kFocal_px, (v - 240.0) / kFocal_px, 1.0);
    feature.rays.push_back(rayTo(point, 0, port_mm, random));
    const BodyRay other = rayTo(point, 1, port_mm, random);
    const bool is_stereo = share(*random) < 0.65 && other.pixel.x() >= 0.0;
    if (is_stereo) feature.rays.push_back(other);
    if (is_stereo || share(*random) < 0.7) {
      feature.point_B = point;
      feature.distance_sigma_m = 0.02 * depth_m * depth_m;
    }
    features.push_back(std::move(feature));
  }
  return features;
}

Mat6 someCovariance(double sigma, std::mt19937* random) {
  Mat6 factor = Mat6::Identity();
  std::normal_distribution<double> normal;
  for (double& element : factor.reshaped()) element += 0.3 * normal(*random);
  return sigma * sigma * factor * factor.transpose();
}

MapKeyframe passageKeyframe(DiveId dive, int number, int feature_count, std::mt19937* random) {
  MapKeyframe keyframe;
  keyframe.dive = dive;
  keyframe.time = Time::fromNanoseconds(1795255200000000000 + 700000000LL * number);
  keyframe.odom_from_body = Rigid3(Quat(Eigen::AngleAxisd(0.01 * number, Vec3(0.1, 0.2, 0.97).normalized())),
                                   Vec3(0.33 * number, 0.0, -5.0));
  keyframe.covariance = someCovariance(0.01 * (number + 1), random);
  keyframe.north_from_odom_rad = 0.001 * number;
  if (number % 2 == 0) keyframe.heading_sigma_rad = 0.02;
  if (number % 3 == 0) keyframe.depth_m = ScalarPrior{5.0, 0.05};
  if (number % 4 == 1) keyframe.field = KeyframeField{Vec3(1e-6, 24e-6, -38e-6 - 1e-7 * number), 0.1e-6};
  keyframe.features = stereoFeatures(feature_count, 0.0, random);
  return keyframe;
}

MapDive namedDive(const std::string& name) {
  MapDive dive;
  dive.name = name;
  dive.recording = "/dives/" + name;
  dive.fingerprint = "0123abcd";
  dive.start = Time::fromNanoseconds(1795255200000000000);
  dive.end = dive.start + Duration::fromSeconds(600.0);
  dive.heading_reference = HeadingReference::Magnetic;
  dive.rig = "cam0: {}\n";
  dive.depth_reference = "surface of the lake";
  dive.settings_digest = "77";
  return dive;
}

}  // namespace lodeline::test

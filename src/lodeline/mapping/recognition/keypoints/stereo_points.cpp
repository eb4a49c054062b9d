#include "lodeline/mapping/recognition/keypoints/stereo_points.h"

#include <algorithm>
#include <cmath>

#include "lodeline/frontend/tracking/match_quality.h"
#include "lodeline/frontend/tracking/patch.h"

namespace lodeline {
namespace {

constexpr int kLevels = 4;

class SecondView {
 public:
  SecondView(const cv::Mat& first, const cv::Mat& second, int camera, const FrameGeometry& geometry)
      : first_(first, kLevels), second_(second, kLevels), camera_(camera), geometry_(geometry) {}

  std::optional<BodyRay> find(const BodyRay& ray, double distance_m, double sigma_px) const {
    const auto looks =
        PatchTemplate::extract(first_, ray.pixel.cast<float>(), kLevels, PatchMotion::Deformation);
    if (!looks) return std::nullopt;
    std::optional<BodyRay> best;
    float best_correlation = 0.0F;
    for (const double factor : {1.0, 0.75, 1.4}) {
      const auto start = project(ray.origin_B + factor * distance_m * ray.bearing_B);
      if (!start) continue;
      PatchWarp warp{start->cast<float>(), Eigen::Matrix2f::Identity()};
      const auto match = looks->align(second_, 2, PatchMotion::Deformation, warp);
      if (!match || !MatchQuality{}.accepts(*match) || match->correlation <= best_correlation) continue;
      const auto found = check(ray, warp, sigma_px);
      if (!found) continue;
      best = found;
      best_correlation = match->correlation;
      break;
    }
    return best;
  }

 private:
  const Camera& camera() const { return *geometry_.cameras[static_cast<size_t>(camera_)]; }
  const Rigid3& bodyFromCamera() const { return geometry_.body_from_cameras[static_cast<size_t>(camera_)]; }
  std::optional<Vec2> project(const Vec3& point_B) const {
    const Vec3 point_C = bodyFromCamera().inverse() * point_B;
    if (point_C.z() <= 0.0) return std::nullopt;
    const auto pixel = camera().project(point_C);
    return pixel && camera().contains(*pixel, 8.0) ? pixel : std::nullopt;
  }
  std::optional<BodyRay> check(const BodyRay& ray, const PatchWarp& warp, double sigma_px) const {
    constexpr double kBack_px = 0.7, kEpipolar_sigmas = 3.0;
    if (!camera().contains(warp.position.cast<double>(), 8.0)) return std::nullopt;
    const auto looks = PatchTemplate::extract(second_, warp.position, 2, PatchMotion::Shift);
    if (!looks) return std::nullopt;
    PatchWarp back{ray.pixel.cast<float>() + Eigen::Vector2f(1.0F, 0.5F), warp.linear.inverse()};
    if (!looks->align(first_, 1, PatchMotion::Shift, back)) return std::nullopt;
    if ((back.position.cast<double>() - ray.pixel).norm() > kBack_px) return std::nullopt;
    const auto second = geometry_.rayOf(camera_, warp.position.cast<double>(), sigma_px);
    if (!second) return std::nullopt;
    const Vec3 normal = (second->origin_B - ray.origin_B).cross(ray.bearing_B);
    if (normal.norm() < 1e-9) return std::nullopt;
    const double off_rad = std::abs(normal.normalized().dot(second->bearing_B));
    if (off_rad > kEpipolar_sigmas * second->sigma_rad) return std::nullopt;
    return second;
  }

  ImagePyramid first_, second_;
  int camera_;
  const FrameGeometry& geometry_;
};

}  // namespace

std::vector<std::optional<BodyRay>> secondRays(const cv::Mat& first, const cv::Mat& second, int camera,
                                               const FrameGeometry& geometry, const std::vector<BodyRay>& rays,
                                               const std::vector<double>& distances_m, double sigma_px) {
  const SecondView view(first, second, camera, geometry);
  std::vector<std::optional<BodyRay>> result;
  for (size_t i = 0; i < rays.size(); ++i) result.push_back(view.find(rays[i], distances_m[i], sigma_px));
  return result;
}

}  // namespace lodeline

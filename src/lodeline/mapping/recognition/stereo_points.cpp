#include "lodeline/mapping/recognition/stereo_points.h"

#include <cmath>

#include "lodeline/frontend/tracking/match_quality.h"
#include "lodeline/frontend/tracking/patch.h"

namespace lodeline {
namespace {

constexpr int kLevels = 4, kCoarsest = 2;
constexpr double kBorder_px = 8.0;

/// The image of a further camera beside that of camera 0.
class FurtherView {
 public:
  FurtherView(const cv::Mat& first, const cv::Mat& further, int camera, const FrameGeometry& geometry)
      : first_(first, kLevels),
        further_(further, kLevels),
        camera_(camera),
        geometry_(geometry),
        camera_from_body_(geometry.body_from_cameras[static_cast<size_t>(camera)].inverse()) {}

  std::optional<BodyRay> find(const ExpectedPoint& point, double sigma_px) const {
    const auto looks = PatchTemplate::extract(first_, point.ray.pixel.cast<float>(), kLevels);
    if (!looks) return std::nullopt;
    for (const double factor : {1.0, 0.75, 1.4}) {
      const Vec3 start_B = point.ray.origin_B + factor * point.distance_m * point.ray.bearing_B;
      const auto start = project(start_B);
      if (!start) continue;
      PatchWarp warp{start->cast<float>(), Eigen::Matrix2f::Identity()};
      const auto match = looks->align(further_, kCoarsest, PatchMotion::Deformation, warp);
      if (!match || !MatchQuality{}.accepts(*match) || !leadsBack(point.ray, warp)) continue;
      if (auto ray = rayAt(point.ray, warp.position.cast<double>(), sigma_px)) return ray;
    }
    return std::nullopt;
  }

 private:
  const Camera& camera() const { return *geometry_.cameras[static_cast<size_t>(camera_)]; }

  std::optional<Vec2> project(const Vec3& point_B) const {
    const Vec3 point_C = camera_from_body_ * point_B;
    if (point_C.z() <= 0.0) return std::nullopt;
    const auto pixel = camera().project(point_C);
    return pixel && camera().contains(*pixel, kBorder_px) ? pixel : std::nullopt;
  }

  bool leadsBack(const BodyRay& ray, const PatchWarp& warp) const {
    constexpr double kNear_px = 0.7;
    const auto looks = PatchTemplate::extract(further_, warp.position, kCoarsest, PatchMotion::Shift);
    if (!looks) return false;
    // It starts a little off, so that it has to find the pixel.
    PatchWarp back{ray.pixel.cast<float>() + Eigen::Vector2f(1.0F, 0.5F), warp.linear.inverse()};
    return looks->align(first_, 1, PatchMotion::Shift, back) &&
           (back.position.cast<double>() - ray.pixel).norm() <= kNear_px;
  }

  /// The ray of a pixel that is on the epipolar plane of a ray of camera 0.
  std::optional<BodyRay> rayAt(const BodyRay& first, const Vec2& pixel, double sigma_px) const {
    constexpr double kGate_sigmas = 3.0;
    if (!camera().contains(pixel, kBorder_px)) return std::nullopt;
    const auto further = geometry_.rayOf(camera_, pixel, sigma_px);
    if (!further) return std::nullopt;
    const Vec3 normal = (further->origin_B - first.origin_B).cross(first.bearing_B);
    const double off = std::abs(normal.dot(further->bearing_B));
    return off <= kGate_sigmas * further->sigma_rad * normal.norm() ? further : std::nullopt;
  }

  ImagePyramid first_, further_;
  int camera_;
  const FrameGeometry& geometry_;
  Rigid3 camera_from_body_;
};

}  // namespace

std::vector<std::optional<BodyRay>> raysOfFurtherCamera(const cv::Mat& first, const cv::Mat& further,
                                                        int camera, const FrameGeometry& geometry,
                                                        const std::vector<ExpectedPoint>& points,
                                                        double sigma_px) {
  const FurtherView view(first, further, camera, geometry);
  std::vector<std::optional<BodyRay>> rays;
  for (const ExpectedPoint& point : points) rays.push_back(view.find(point, sigma_px));
  return rays;
}

}  // namespace lodeline

#include "simulation/rendering/board/printed_panel.h"

#include <algorithm>

namespace lodeline {
namespace {

constexpr float kInk = 0.06f;  // of the light that white paper reflects
constexpr int kSamples = 6;    // along each side of a pixel

}  // namespace

void addRectangle(const Vec3& centre_T, double half_width_m, double half_height_m, const Material& material,
                  const Rigid3& world_from_print, TriangleMesh* mesh) {
  uint32_t corners[4];
  for (int k = 0; k < 4; ++k) {
    const Vec3 offset_T(k == 0 || k == 3 ? -half_width_m : half_width_m,
                        k < 2 ? -half_height_m : half_height_m, 0.0);
    corners[k] =
        mesh->addVertex((world_from_print * Vec3(centre_T + offset_T)).template cast<float>(), material);
  }
  mesh->triangles.push_back({corners[0], corners[1], corners[2]});
  mesh->triangles.push_back({corners[0], corners[2], corners[3]});
}

PanelSampler::PanelSampler(const PrintedPanel& panel, const CameraOptics& optics,
                           const Rigid3& world_from_camera)
    : panel_(panel), optics_(optics) {
  const Rigid3 print_from_camera = panel.world_from_print.inverse() * world_from_camera;
  print_from_camera_ = print_from_camera.rotation.toRotationMatrix();
  camera_T_ = print_from_camera.translation;
}

float PanelSampler::brightness(int x, int y) const {
  const int width = optics_.width(), height = optics_.height();
  // Within a pixel, its ray is linear in the place to 1e-4 px.
  const int left = std::max(x - 1, 0), right = std::min(x + 1, width - 1);
  const int above = std::max(y - 1, 0), below = std::min(y + 1, height - 1);
  const auto directionAt = [&](int u, int v) -> Vec3 {
    return print_from_camera_ * optics_.direction(v * width + u).cast<double>();
  };
  const auto originAt = [&](int u, int v) -> Vec3 {
    return print_from_camera_ * optics_.origin(v * width + u).cast<double>();
  };
  const Vec3 direction = directionAt(x, y), origin = camera_T_ + originAt(x, y);
  const Vec3 direction_by_x = (directionAt(right, y) - directionAt(left, y)) / (right - left);
  const Vec3 direction_by_y = (directionAt(x, below) - directionAt(x, above)) / (below - above);
  const Vec3 origin_by_x = (originAt(right, y) - originAt(left, y)) / (right - left);
  const Vec3 origin_by_y = (originAt(x, below) - originAt(x, above)) / (below - above);
  int black = 0;
  for (int j = 0; j < kSamples; ++j) {
    const double dy = (j + 0.5) / kSamples - 0.5;
    for (int i = 0; i < kSamples; ++i) {
      const double dx = (i + 0.5) / kSamples - 0.5;
      const Vec3 along = direction + dx * direction_by_x + dy * direction_by_y;
      const Vec3 from = origin + dx * origin_by_x + dy * origin_by_y;
      const double range = -from.z() / along.z();
      if (panel_.isBlack(from.x() + range * along.x(), from.y() + range * along.y())) ++black;
    }
  }
  const float share = static_cast<float>(black) / (kSamples * kSamples);
  return 1.0f - (1.0f - kInk) * share;
}

}  // namespace lodeline

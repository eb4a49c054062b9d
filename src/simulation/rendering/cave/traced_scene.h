#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lodeline/types.h"
#include "simulation/rendering/cave/triangle_mesh.h"

struct RTCSceneTy;
struct RTCDeviceTy;

namespace lodeline {

/// Number of rays traced together. Neighbouring pixels traverse mostly the same nodes of the bounding
/// hierarchy.
inline constexpr int kRayPacketSize = 16;

/// Sixteen rays, world coordinates (m); directions of unit length.
struct alignas(64) RayPacket {
  float origin[3][kRayPacketSize];
  float direction[3][kRayPacketSize];
  float max_range_m[kRayPacketSize];
  alignas(64) int active[kRayPacketSize];  ///< -1 to trace, 0 to skip

  Vec3f originOf(int i) const { return {origin[0][i], origin[1][i], origin[2][i]}; }
  Vec3f directionOf(int i) const { return {direction[0][i], direction[1][i], direction[2][i]}; }
  void set(int i, const Vec3f& from, const Vec3f& along, float max_range) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis][i] = from[axis];
      direction[axis][i] = along[axis];
    }
    max_range_m[i] = max_range;
    active[i] = -1;
  }
  void disable(int i) {
    set(i, Vec3f::Zero(), Vec3f::UnitZ(), 0.0f);
    active[i] = 0;
  }
};

/// Intersections of a packet's rays with the surface.
struct alignas(64) HitPacket {
  float range_m[kRayPacketSize];  ///< infinite without intersection
  float u[kRayPacketSize];        ///< barycentric weights of the triangle's second and third vertex
  float v[kRayPacketSize];
  uint32_t triangle[kRayPacketSize];
  int body[kRayPacketSize];  ///< index of the moving body (bodies/ellipsoid.h) instead; -1: the scene
};

/// Surface properties at an intersection.
struct SurfacePoint {
  Vec3f normal = Vec3f::UnitZ();  ///< interpolated between the vertices, unit
  float reflectance = 0.0f;       ///< 0..1
  float contrast = 0.0f;          ///< 0..1
  float gloss = 0.0f;             ///< 0..1
};

/// A triangle mesh in an Embree scene. Immutable after construction, safe to share between threads.
class TracedScene {
 public:
  /// Takes a mesh with normals. Throws std::runtime_error where Embree fails.
  explicit TracedScene(TriangleMesh mesh);
  ~TracedScene();
  TracedScene(const TracedScene&) = delete;
  TracedScene& operator=(const TracedScene&) = delete;

  void intersect(const RayPacket& rays, HitPacket& hits) const;

  /// Bit mask of occluded rays: bit i is set where a surface is within max_range_m along ray i.
  uint32_t occluded(const RayPacket& rays) const;

  SurfacePoint surfaceAt(const HitPacket& hits, int i) const;

  /// Distance (m) to the first surface along a unit direction; nothing where the ray hits none.
  std::optional<double> range(const Vec3& origin_W, const Vec3& direction_W) const;

  size_t triangleCount() const { return triangle_count_; }

 private:
  struct VertexSurface {
    int16_t normal[3];
    Material material;
  };

  RTCDeviceTy* device_ = nullptr;
  RTCSceneTy* scene_ = nullptr;
  const std::array<uint32_t, 3>* triangles_ = nullptr;  ///< in Embree's buffer
  size_t triangle_count_ = 0;
  std::vector<VertexSurface> vertices_;
};

}  // namespace lodeline

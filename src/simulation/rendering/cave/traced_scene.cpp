#include "simulation/rendering/cave/traced_scene.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "simulation/rendering/cave/embree.h"

namespace lodeline {
namespace {

void require(RTCDevice device, const char* what) {
  const RTCError error = device != nullptr ? rtcGetDeviceError(device) : rtcGetDeviceError(nullptr);
  if (error != RTC_ERROR_NONE) {
    throw std::runtime_error(std::string("Embree could not ") + what + " (error " + std::to_string(error) +
                             "); most likely the machine ran out of memory");
  }
}

/// Copies the rays; Embree's packet has the same layout but more fields.
void fill(const RayPacket& rays, RTCRay16& out) {
  std::memcpy(out.org_x, rays.origin[0], sizeof out.org_x);
  std::memcpy(out.org_y, rays.origin[1], sizeof out.org_y);
  std::memcpy(out.org_z, rays.origin[2], sizeof out.org_z);
  std::memcpy(out.dir_x, rays.direction[0], sizeof out.dir_x);
  std::memcpy(out.dir_y, rays.direction[1], sizeof out.dir_y);
  std::memcpy(out.dir_z, rays.direction[2], sizeof out.dir_z);
  std::memcpy(out.tfar, rays.max_range_m, sizeof out.tfar);
  std::memset(out.tnear, 0, sizeof out.tnear);
  std::memset(out.time, 0, sizeof out.time);
  std::memset(out.mask, 0xFF, sizeof out.mask);
  std::memset(out.flags, 0, sizeof out.flags);
}

}  // namespace

TracedScene::TracedScene(TriangleMesh mesh) : triangle_count_(mesh.triangles.size()) {
  device_ = rtcNewDevice(nullptr);
  if (device_ == nullptr) require(nullptr, "start");
  scene_ = rtcNewScene(device_);
  // Robust mode: no ray passes between two adjacent triangles.
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3f), mesh.positions.size());
  void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                          sizeof(mesh.triangles[0]), mesh.triangles.size());
  require(device_, "hold the world's triangles");
  std::memcpy(vertices, mesh.positions.data(), sizeof(Vec3f) * mesh.positions.size());
  std::memcpy(indices, mesh.triangles.data(), sizeof(mesh.triangles[0]) * mesh.triangles.size());
  triangles_ = static_cast<const std::array<uint32_t, 3>*>(indices);
  vertices_.resize(mesh.positions.size());
  for (size_t i = 0; i < vertices_.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      vertices_[i].normal[axis] = static_cast<int16_t>(std::lround(32767.0f * mesh.normals[i][axis]));
    }
    vertices_[i].material = mesh.materials[i];
  }
  mesh = {};  // freed before the hierarchy is built, to reduce peak memory
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  require(device_, "build the world's hierarchy");
}

TracedScene::~TracedScene() {
  if (scene_ != nullptr) rtcReleaseScene(scene_);
  if (device_ != nullptr) rtcReleaseDevice(device_);
}

void TracedScene::intersect(const RayPacket& rays, HitPacket& hits) const {
  RTCRayHit16 query;
  fill(rays, query.ray);
  std::memset(query.hit.geomID, 0xFF, sizeof query.hit.geomID);
  std::memset(query.hit.instID, 0xFF, sizeof query.hit.instID);
  embree::intersect16(rays.active, scene_, &query);
  for (int i = 0; i < kRayPacketSize; ++i) {
    const bool hit = rays.active[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    hits.range_m[i] = hit ? query.ray.tfar[i] : std::numeric_limits<float>::infinity();
    hits.u[i] = hit ? query.hit.u[i] : 0.0f;
    hits.v[i] = hit ? query.hit.v[i] : 0.0f;
    hits.triangle[i] = hit ? query.hit.primID[i] : 0;
    hits.body[i] = -1;
  }
}

uint32_t TracedScene::occluded(const RayPacket& rays) const {
  RTCRay16 query;
  fill(rays, query);
  embree::occluded16(rays.active, scene_, &query);
  uint32_t bits = 0;
  for (int i = 0; i < kRayPacketSize; ++i) {
    // Embree sets the range of an occluded ray to minus infinity.
    if (rays.active[i] != 0 && query.tfar[i] < 0.0f) bits |= 1u << i;
  }
  return bits;
}

SurfacePoint TracedScene::surfaceAt(const HitPacket& hits, int i) const {
  const auto& triangle = triangles_[hits.triangle[i]];
  const float weights[3] = {1.0f - hits.u[i] - hits.v[i], hits.u[i], hits.v[i]};
  SurfacePoint point;
  Vec3f normal = Vec3f::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    const VertexSurface& vertex = vertices_[triangle[corner]];
    const float weight = weights[corner];
    normal += weight * Vec3f(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
    point.reflectance += weight * vertex.material.reflectance;
    point.contrast += weight * vertex.material.contrast;
    point.gloss += weight * vertex.material.gloss;
  }
  const float length = normal.norm();
  point.normal = length > 0.0f ? Vec3f(normal / length) : Vec3f::UnitZ();
  constexpr float kByte = 1.0f / 255.0f;
  point.reflectance *= kByte;
  point.contrast *= kByte;
  point.gloss *= kByte;
  return point;
}

std::optional<double> TracedScene::range(const Vec3& origin_W, const Vec3& direction_W) const {
  RTCRayHit query;
  query.ray.org_x = static_cast<float>(origin_W.x());
  query.ray.org_y = static_cast<float>(origin_W.y());
  query.ray.org_z = static_cast<float>(origin_W.z());
  query.ray.dir_x = static_cast<float>(direction_W.x());
  query.ray.dir_y = static_cast<float>(direction_W.y());
  query.ray.dir_z = static_cast<float>(direction_W.z());
  query.ray.tnear = 0.0f;
  query.ray.tfar = std::numeric_limits<float>::infinity();
  query.ray.time = 0.0f;
  query.ray.mask = 0xFFFFFFFFu;
  query.ray.id = 0;
  query.ray.flags = 0;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::intersect1(scene_, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return query.ray.tfar;
}

}  // namespace lodeline

#include "lodeline/output/foxglove/foxglove_messages.h"

#include <array>
#include <bit>
#include <cstring>

#include "lodeline/output/report/data/base64.h"

namespace lodeline::foxglove {
namespace {

static_assert(std::endian::native == std::endian::little, "fields of points are little endian");

/// Numbers of types in foxglove.PackedElementField.
constexpr int kInt32 = 6, kFloat32 = 7;

/// A point as it lies in the data of the cloud.
struct PackedPoint {
  std::array<float, 3> position;
  int32_t observations;
};
static_assert(sizeof(PackedPoint) == 16);

Json vectorJson(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

Json rotationJson(const Quat& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

Json poseJson(const Rigid3& pose) {
  return {{"position", vectorJson(pose.translation)}, {"orientation", rotationJson(pose.rotation)}};
}

}  // namespace

Json timeJson(Time time) {
  return {{"sec", time.nanoseconds() / 1'000'000'000}, {"nsec", time.nanoseconds() % 1'000'000'000}};
}

Json transformMessage(Time time, const std::string& parent, const std::string& child,
                      const Rigid3& parent_from_child) {
  return {{"timestamp", timeJson(time)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vectorJson(parent_from_child.translation)},
          {"rotation", rotationJson(parent_from_child.rotation)}};
}

Json poseMessage(const StampedPose& pose, const std::string& frame) {
  return {{"timestamp", timeJson(pose.time)}, {"frame_id", frame}, {"pose", poseJson(pose.world_from_body)}};
}

Json pathMessage(Time time, const std::vector<StampedPose>& poses, const std::string& frame) {
  Json list = Json::array();
  for (const StampedPose& pose : poses) list.push_back(poseJson(pose.world_from_body));
  return {{"timestamp", timeJson(time)}, {"frame_id", frame}, {"poses", std::move(list)}};
}

Json landmarksMessage(Time time, const std::vector<MapLandmark>& landmarks, const std::string& frame) {
  std::vector<uint8_t> data(landmarks.size() * sizeof(PackedPoint));
  for (size_t i = 0; i < landmarks.size(); ++i) {
    const Eigen::Vector3f position = landmarks[i].position.cast<float>();
    const PackedPoint point{{position.x(), position.y(), position.z()}, landmarks[i].observations};
    std::memcpy(data.data() + i * sizeof(point), &point, sizeof(point));
  }
  Json fields = Json::array();
  int offset = 0;
  for (const char* name : {"x", "y", "z", "observations"}) {
    const bool is_count = std::strcmp(name, "observations") == 0;
    fields.push_back({{"name", name}, {"offset", offset}, {"type", is_count ? kInt32 : kFloat32}});
    offset += 4;
  }
  return {{"timestamp", timeJson(time)},         {"frame_id", frame},           {"pose", poseJson(Rigid3())},
          {"point_stride", sizeof(PackedPoint)}, {"fields", std::move(fields)}, {"data", base64(data)}};
}

Json logMessage(Time time, Level level, const std::string& name, const std::string& text) {
  return {{"timestamp", timeJson(time)},
          {"level", static_cast<int>(level)},
          {"message", text},
          {"name", name},
          {"file", ""},
          {"line", 0}};
}

Json imageMessage(Time time, std::span<const uint8_t> jpeg, const std::string& frame) {
  return {{"timestamp", timeJson(time)}, {"frame_id", frame}, {"data", base64(jpeg)}, {"format", "jpeg"}};
}

}  // namespace lodeline::foxglove

#include <fmt/format.h>

#include <cstring>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/evaluation/trajectory/read_formats.h"

namespace lodeline {
namespace {

/// Converts COLMAP's entries of both layouts to a trajectory.
class ColmapTrajectory {
 public:
  ColmapTrajectory(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                   Diagnostics& diagnostics)
      : options_(options), diagnostics_(diagnostics) {
    trajectory_.name = path.string();
    if (options.image_times) times_ = ImageTimes(*options.image_times);
  }

  /// Adds one image with COLMAP's world to camera transformation.
  void add(const std::string& where, const Quat& camera_from_world_rotation, const Vec3& camera_from_world_m,
           const std::string& image_name) {
    const std::optional<Time> time = times_.find(image_name);
    if (!time) {
      throw InputError(fmt::format("{}: no time for image '{}'; {}", where, image_name,
                                   options_.image_times
                                       ? "it is not listed in " + options_.image_times->string()
                                       : "give a file of `name time` lines with --image-times"));
    }
    const auto camera_from_world =
        poseFromNumbers(where, camera_from_world_m, camera_from_world_rotation, diagnostics_);
    if (!camera_from_world) return;
    Rigid3 world_from_body = camera_from_world->inverse();
    if (options_.body_from_camera) world_from_body = world_from_body * options_.body_from_camera->inverse();
    trajectory_.poses.push_back({*time, world_from_body});
  }

  Trajectory take() { return std::move(trajectory_); }

 private:
  const TrajectoryReadOptions& options_;
  Diagnostics& diagnostics_;
  ImageTimes times_;
  Trajectory trajectory_;
};

/// Reads fixed-size little-endian values from a buffer and throws beyond its end.
class ByteReader {
 public:
  ByteReader(std::string bytes, std::string name) : bytes_(std::move(bytes)), name_(std::move(name)) {}

  template <typename T>
  T take() {
    T value;
    require(sizeof(T));
    std::memcpy(&value, bytes_.data() + position_, sizeof(T));
    position_ += sizeof(T);
    return value;
  }

  std::string takeName() {
    const std::size_t end = bytes_.find('\0', position_);
    if (end == std::string::npos) require(bytes_.size());
    std::string name = bytes_.substr(position_, end - position_);
    position_ = end + 1;
    return name;
  }

  void skip(uint64_t count, uint64_t item_size) {
    if (count > bytes_.size() / item_size) require(bytes_.size());
    require(count * item_size);
    position_ += count * item_size;
  }

 private:
  void require(std::size_t size) const {
    if (bytes_.size() - position_ >= size && size < bytes_.size()) return;
    throw InputError(
        fmt::format("{}: ends at byte {} in the middle of an image entry; the file is cut off or is "
                    "not a COLMAP images.bin",
                    name_, bytes_.size()));
  }

  std::string bytes_;
  std::string name_;
  std::size_t position_ = 0;
};

Vec3 takeVec3(ByteReader& reader) {
  Vec3 v;
  for (int i = 0; i < 3; ++i) v[i] = reader.take<double>();
  return v;
}

Quat takeQuat(ByteReader& reader) {
  const double w = reader.take<double>();
  const Vec3 xyz = takeVec3(reader);
  return Quat(w, xyz.x(), xyz.y(), xyz.z());
}

}  // namespace

// Two lines per image: `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`, then its 2D points, possibly an empty
// line. (COLMAP documentation, "Output format".)
Trajectory readColmapText(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics) {
  const TextTable table = readTextTable(path);
  ColmapTrajectory result(path, options, diagnostics);
  int pose_line_number = -1;
  for (const TextLine& line : table.lines) {
    if (line.number == pose_line_number + 1 && pose_line_number > 0) continue;
    pose_line_number = line.number;
    if (line.fields.size() < 10) {
      throw InputError(
          fmt::format("{}: {} columns, a COLMAP image line needs 10 and is followed by the line of its "
                      "points (which may be empty)",
                      table.where(line), line.fields.size()));
    }
    const auto value = [&](std::size_t column) { return table.number(line, column); };
    std::string name = line.fields[9];
    for (std::size_t i = 10; i < line.fields.size(); ++i) name += " " + line.fields[i];
    result.add(table.where(line), Quat(value(1), value(2), value(3), value(4)),
               Vec3(value(5), value(6), value(7)), name);
  }
  return result.take();
}

Trajectory readColmapBinary(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                            Diagnostics& diagnostics) {
  ByteReader reader(readFileBytes(path), path.string());
  ColmapTrajectory result(path, options, diagnostics);
  constexpr uint64_t kPointSize = 2 * sizeof(double) + sizeof(int64_t);
  const uint64_t image_count = reader.take<uint64_t>();
  for (uint64_t i = 0; i < image_count; ++i) {
    const int32_t image_id = reader.take<int32_t>();
    const Quat rotation = takeQuat(reader);
    const Vec3 translation = takeVec3(reader);
    reader.take<int32_t>();  // camera id
    const std::string name = reader.takeName();
    reader.skip(reader.take<uint64_t>(), kPointSize);
    result.add(fmt::format("{}: image {}", path.string(), image_id), rotation, translation, name);
  }
  return result.take();
}

}  // namespace lodeline

#include "lodeline/report/landmark_writer.h"

#include <fmt/ostream.h>

#include "lodeline/base/output_file.h"

namespace lodeline {
namespace {

constexpr const char* kBeforeCount =
    "ply\nformat binary_little_endian 1.0\ncomment landmarks in the world frame (east, north, up), m\n"
    "element vertex ";
constexpr const char* kAfterCount =
    "\nproperty float x\nproperty float y\nproperty float z\nproperty int sightings\nend_header\n";

}  // namespace

LandmarkWriter::LandmarkWriter(const std::filesystem::path& folder, const std::string& name)
    : file_(folder / name), stream_(openOutput(file_)) {
  // Zero-padded so that the final count takes the same room.
  fmt::print(stream_, "{}{:012}{}", kBeforeCount, 0, kAfterCount);
  stream_.flush();
}

LandmarkWriter::~LandmarkWriter() {
  try {
    finish();
  } catch (const InputError&) {
    // Another error is on its way already; it says more.
  }
}

void LandmarkWriter::write(const std::vector<MapPoint>& points) {
  for (const MapPoint& point : points) {
    const Eigen::Vector3f position = point.position_W.cast<float>();
    const int32_t sightings = point.sightings;
    stream_.write(reinterpret_cast<const char*>(position.data()), sizeof(float) * 3);
    stream_.write(reinterpret_cast<const char*>(&sightings), sizeof(sightings));
    ++count_;
  }
  // A run that is killed leaves what it has found.
  stream_.flush();
}

void LandmarkWriter::finish() {
  if (!stream_.is_open()) return;
  stream_.seekp(static_cast<std::streamoff>(std::char_traits<char>::length(kBeforeCount)));
  fmt::print(stream_, "{:012}", count_);
  closeOutput(file_, &stream_);
}

}  // namespace lodeline

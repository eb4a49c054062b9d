#include "lodeline/output/files/landmark_writer.h"

#include <fmt/ostream.h>

#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

/// Header before the count, padded so that the finished header has the same length.
std::string beforeCount(const std::string& world) {
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment landmarks, m, z up; {:<60}\nelement vertex ", world);
}

std::string worldOf(HeadingReference reference) {
  if (reference == HeadingReference::True || reference == HeadingReference::Magnetic)
    return fmt::format("x east, y north ({})", toString(reference));
  return "x, y from the start heading, not from north";
}

constexpr const char* kAfterCount =
    "\nproperty float x\nproperty float y\nproperty float z\nproperty int observations\nend_header\n";

}  // namespace

LandmarkWriter::LandmarkWriter(const std::filesystem::path& folder, const std::string& name)
    : file_(folder / name), stream_(openOutput(file_)) {
  // Zero-padded so that the final count has the same length.
  fmt::print(stream_, "{}{:012}{}", beforeCount("x, y as in trajectory.tum of a run not completed"), 0,
             kAfterCount);
  stream_.flush();
}

LandmarkWriter::~LandmarkWriter() {
  if (stream_.is_open()) writeCount();
}

void LandmarkWriter::write(const std::vector<MapPoint>& points) {
  for (const MapPoint& point : points) {
    const Eigen::Vector3f position = point.position_W.cast<float>();
    const int32_t observations = point.observations;
    stream_.write(reinterpret_cast<const char*>(position.data()), sizeof(float) * 3);
    stream_.write(reinterpret_cast<const char*>(&observations), sizeof(observations));
    ++count_;
  }
  // A killed run keeps its results.
  stream_.flush();
}

void LandmarkWriter::writeCount() {
  stream_.seekp(static_cast<std::streamoff>(beforeCount("").size()));
  fmt::print(stream_, "{:012}", count_);
}

void LandmarkWriter::finish(HeadingReference reference, const std::optional<WorldTurn>& turn) {
  if (!stream_.is_open()) return;
  stream_.seekp(0);
  fmt::print(stream_, "{}", beforeCount(worldOf(reference)));
  writeCount();
  closeOutput(file_, &stream_);
  if (turn) turnPoints(*turn);
}

void LandmarkWriter::turnPoints(const WorldTurn& turn) const {
  constexpr std::streamoff kPointSize = 3 * sizeof(float) + sizeof(int32_t);
  const auto first =
      static_cast<std::streamoff>(beforeCount("").size() + std::char_traits<char>::length(kAfterCount) + 12);
  std::fstream file(file_, std::ios::binary | std::ios::in | std::ios::out);
  for (int64_t i = 0; i < count_; ++i) {
    Eigen::Vector3f position;
    file.seekg(first + i * kPointSize);
    file.read(reinterpret_cast<char*>(position.data()), 3 * sizeof(float));
    position = turn.apply(position.cast<double>()).cast<float>();
    file.seekp(first + i * kPointSize);
    file.write(reinterpret_cast<const char*>(position.data()), 3 * sizeof(float));
  }
  file.close();
  if (!file) throw InputError(file_.string() + ": turning its points to north failed; is the disk full?");
}

}  // namespace lodeline

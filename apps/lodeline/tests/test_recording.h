#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lodeline::test {

/// The files of `writeRoomRecording`.
struct RoomRecording {
  std::filesystem::path data;   ///< contains mav0
  std::filesystem::path truth;  ///< body in world, TUM layout
  std::vector<std::string> image_names;

  std::filesystem::path sensor(const std::string& name) const { return data / "mav0" / name; }
  std::filesystem::path csv(const std::string& name) const { return sensor(name) / "data.csv"; }
  std::filesystem::path image(int camera, size_t index) const {
    return sensor("cam" + std::to_string(camera)) / "data" / image_names[index];
  }
};

/// Writes a small stereo recording in the EuRoC ASL layout: a rig moved by hand for 1.5 s in a box-shaped
/// room with textured walls. Images have 320x240 px at 20 Hz. The IMU has 200 Hz from 0.5 s before the first
/// image to the last one, constant biases and no noise.
RoomRecording writeRoomRecording(const std::filesystem::path& folder);

/// Number and stamp (ns) of the images.
inline constexpr int kRoomImages = 31;
int64_t roomImageStamp_ns(int index);

/// Replaces an image by a uniformly grey one of the same size.
void writeBlankImage(const std::filesystem::path& file);

/// Applies `edit` to the lines of a text file (without line ends) and writes them back.
void editLines(const std::filesystem::path& file, const std::function<void(std::vector<std::string>&)>& edit);
/// Replaces the first occurrence of a text in a file; throws where there is none.
void replaceText(const std::filesystem::path& file, const std::string& from, const std::string& to);

}  // namespace lodeline::test

#pragma once

#include <deque>
#include <filesystem>
#include <optional>

#include "lodeline/frontend/front_end.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

/// The first camera's image with its tracks (drawTracks()) as a JPEG with a width of at most `max_width_px`.
/// Empty where the camera gave no image.
std::vector<uint8_t> trackPicture(const FramePacket& packet, const FrontEnd& front_end, int max_width_px);

/// Writes small images with tracks, distributed evenly over a run of any length, for report.html:
/// `pictures/STAMP.jpg` in the output folder, STAMP as in states.csv. The first interval is two seconds;
/// whenever there are kMost images, every second one is removed and the interval doubles.
class SamplePictures {
 public:
  static constexpr size_t kMost = 100;

  /// Creates the folder, and removes images of an earlier run from it. Throws InputError where that fails.
  explicit SamplePictures(const std::filesystem::path& folder);

  /// To be called after each packet that the front end has processed. Throws InputError where the picture
  /// cannot be written.
  void write(const FramePacket& packet, const FrontEnd& front_end);

 private:
  void thin();

  std::filesystem::path folder_;
  Duration pause_ = Duration::fromSeconds(2.0);
  std::optional<Time> due_;
  std::deque<std::filesystem::path> files_;
};

}  // namespace lodeline

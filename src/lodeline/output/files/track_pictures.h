#pragma once

#include <filesystem>
#include <optional>

#include "lodeline/frontend/front_end.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

/// Writes images with tracks for some frames, as `frames/STAMP.png` in a run's output folder with STAMP in
/// nanoseconds as in the recording; see drawTracks() for their content.
class TrackPictures {
 public:
  /// Creates the folder. `period_s`: interval in seconds of the recording, starting with the first frame; 0
  /// for every frame. Throws UsageError for an invalid interval, InputError where the folder cannot be
  /// created.
  TrackPictures(const std::filesystem::path& folder, double period_s);

  /// To be called after each packet that the front end has processed. Throws InputError where the picture
  /// cannot be written.
  void write(const FramePacket& packet, const FrontEnd& front_end);

 private:
  std::filesystem::path frames_;
  Duration period_;
  std::optional<Time> due_;
};

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <optional>

#include "lodeline/frontend/front_end.h"
#include "lodeline/io/synchronizer/frame_packet.h"

namespace lodeline {

/// Pictures of what the front end follows, now and then a frame, as `frames/STAMP.png` of a run's output
/// folder with STAMP in nanoseconds as the recording writes it; see drawTracks() for what they show.
class TrackPictures {
 public:
  /// Makes the folder. `period_s`: one frame each so many seconds of the recording, the first frame included;
  /// 0 for every frame. Throws UsageError for a period that is none, InputError where the folder cannot be
  /// made.
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

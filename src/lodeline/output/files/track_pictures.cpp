#include "lodeline/output/files/track_pictures.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/draw_tracks.h"

namespace lodeline {
namespace {

constexpr double kLongestPeriod_s = 1e6;

Duration checkedPeriod(double period_s) {
  if (period_s >= 0.0 && period_s <= kLongestPeriod_s) return Duration::fromSeconds(period_s);
  throw UsageError(
      fmt::format("tracks drawn every {:g} s: give a period of 0 to {:g} s", period_s, kLongestPeriod_s));
}

}  // namespace

TrackPictures::TrackPictures(const std::filesystem::path& folder, double period_s)
    : frames_(folder / "frames"), period_(checkedPeriod(period_s)) {
  std::error_code error;
  std::filesystem::create_directories(frames_, error);
  if (error) throw InputError(fmt::format("{}: cannot be created ({})", frames_.string(), error.message()));
}

void TrackPictures::write(const FramePacket& packet, const FrontEnd& front_end) {
  if (due_ && packet.time < *due_) return;
  due_ = packet.time + period_;
  const std::filesystem::path file = frames_ / fmt::format("{}.png", packet.image_stamp.nanoseconds());
  if (!cv::imwrite(file.string(), drawTracks(front_end, packet.images))) {
    throw InputError(file.string() + ": writing failed; is the disk full?");
  }
}

}  // namespace lodeline

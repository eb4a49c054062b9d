#include "lodeline/pipeline/run_progress.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>

namespace lodeline {

void RunProgress::show(const RunSummary& summary, std::optional<double> share_read) {
  const FrameEstimate& frame = summary.last();
  if (!first_) first_ = frame.time;
  if (!progress_.isDue()) return;
  std::optional<double> share = share_read;
  if (length_s_ > 0.0) share = std::max((frame.time - *first_).seconds() / length_s_, share.value_or(0.0));
  const std::string state =
      frame.status == Status::Waiting
          ? "waiting for " + frame.waiting_for
          : fmt::format("{}, {} tracks, {} landmarks", toString(frame.status), frame.tracks, frame.landmarks);
  progress_.show(share, fmt::format("frame {}  {:.1f} x real time  {:.1f} m  {}", summary.frames(),
                                    summary.realTimeFactor(), summary.pathLength_m(), state));
}

}  // namespace lodeline

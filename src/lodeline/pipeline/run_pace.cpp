#include "lodeline/pipeline/run_pace.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace lodeline {

using Clock = std::chrono::steady_clock;

void waitUntil(const std::function<bool()>& is_ready, const std::function<bool()>& is_stopped) {
  while (!is_ready() && !is_stopped()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

RunPace::RunPace(std::optional<double> rate, std::function<bool()> is_stopped)
    : rate_(rate), is_stopped_(std::move(is_stopped)) {}

void RunPace::await(Time time) {
  if (!rate_) return;
  const Clock::time_point now = Clock::now();
  if (last_time_) {
    const std::chrono::duration<double> pause((time - *last_time_).seconds() / *rate_);
    last_due_ = std::max(now, last_due_ + std::chrono::duration_cast<Clock::duration>(pause));
    waitUntil([&] { return Clock::now() + std::chrono::milliseconds(20) >= last_due_; }, is_stopped_);
    if (!is_stopped_()) std::this_thread::sleep_until(last_due_);
  } else {
    last_due_ = now;
  }
  last_time_ = time;
}

}  // namespace lodeline

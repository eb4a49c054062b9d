#include "apps/lodeline/walls/walls_progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace lodeline {

WallsProgress::WallsProgress(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0), begin_(Clock::now()), shown_(begin_) {}

void WallsProgress::show(const std::string& stage, double share) {
  const auto now = Clock::now();
  const bool is_new = stage != stage_;
  if (is_new) {
    stage_ = stage;
    begin_ = now;
  }
  if (quiet_ || (!is_new && now - shown_ < std::chrono::milliseconds(terminal_ ? 300 : 10000))) return;
  shown_ = now;
  const double done = std::clamp(share, 0.0, 1.0);
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const std::string rest =
      done > 0.02 && done < 1.0 ? fmt::format(", {:.0f} s to go", elapsed_s * (1.0 - done) / done) : "";
  fmt::print(stderr, "{}{} {:3.0f} %{}{}", terminal_ ? "\r\033[K" : "", stage, 100.0 * done, rest,
             terminal_ ? "" : "\n");
}

void WallsProgress::end() const {
  if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
}

}  // namespace lodeline

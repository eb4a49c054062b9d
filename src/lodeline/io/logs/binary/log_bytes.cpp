#include "lodeline/io/logs/binary/log_bytes.h"

#include <algorithm>

namespace lodeline {

std::span<const uint8_t> LogBytes::peek(size_t count) {
  constexpr size_t kBlock = 1 << 16;
  while (buffer_.size() - begin_ < count && !is_at_end_) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    const size_t kept = buffer_.size();
    buffer_.resize(kept + std::max(kBlock, count - kept));
    const size_t got = source_->read(reinterpret_cast<char*>(buffer_.data() + kept), buffer_.size() - kept);
    buffer_.resize(kept + got);
    is_at_end_ = got == 0;
  }
  return std::span<const uint8_t>(buffer_).subspan(begin_, std::min(count, buffer_.size() - begin_));
}

void LogBytes::skip(size_t count) {
  constexpr size_t kStep = 1 << 16;
  while (count > 0) {
    const size_t step = peek(std::min(count, kStep)).size();
    if (step == 0) return;
    begin_ += step;
    position_ += step;
    count -= step;
  }
}

bool LogBytes::find(std::span<const uint8_t> pattern) {
  constexpr size_t kView = 1 << 12;
  while (true) {
    const std::span<const uint8_t> view = peek(kView);
    const auto found = std::search(view.begin(), view.end(), pattern.begin(), pattern.end());
    const auto before = static_cast<size_t>(found - view.begin());
    if (found != view.end()) {
      skip(before);
      return true;
    }
    if (view.size() < kView) {
      skip(view.size());
      return false;
    }
    skip(view.size() - pattern.size() + 1);
  }
}

}  // namespace lodeline

#include "lodeline/io/tables/text_lines.h"

#include <algorithm>
#include <cstdint>

namespace lodeline {
namespace {

/// Number of bytes of the first character of `text`; 0 where it is not valid UTF-8.
std::size_t characterSize(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t size = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool is_overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool is_outside = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
  return is_overlong || is_outside ? 0 : size;
}

bool isAscii(std::string_view text) {
  return std::none_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
}

}  // namespace

TextLines::TextLines(std::unique_ptr<ByteSource> bytes, const std::string& name)
    : bytes_(inUtf8(std::move(bytes), name)), buffer_(1 << 16, '\0') {}

bool TextLines::fill() {
  begin_ = 0;
  end_ = bytes_->read(buffer_.data(), buffer_.size());
  bytes_filled_ += end_;
  return end_ > 0;
}

void TextLines::keep(std::string_view part) {
  const std::size_t room = kLongestLine - line_.size();
  was_too_long_ = was_too_long_ || part.size() > room;
  line_.append(part.substr(0, room));
}

bool TextLines::next(std::string_view* line) {
  line_.clear();
  was_too_long_ = false;
  had_no_end_ = false;
  bool has_begun = false;
  while (true) {
    if (begin_ == end_ && !fill()) {
      if (!has_begun) return false;
      had_no_end_ = true;
      break;
    }
    if (skip_line_feed_) {
      skip_line_feed_ = false;
      if (buffer_[begin_] == '\n') {
        ++begin_;
        continue;
      }
    }
    has_begun = true;
    const std::string_view rest(buffer_.data() + begin_, end_ - begin_);
    const std::size_t length = rest.find_first_of("\r\n");
    keep(rest.substr(0, length));
    if (length == std::string_view::npos) {
      begin_ = end_;
      continue;
    }
    begin_ += length + 1;
    skip_line_feed_ = rest[length] == '\r';
    break;
  }
  ++number_;
  if (!isAscii(line_) && !isUtf8(line_)) line_ = fromLatin1(line_);
  *line = line_;
  // In concatenated files, the mark of the second file is at the start of a line.
  if (line->starts_with("\xEF\xBB\xBF")) line->remove_prefix(3);
  return true;
}

bool isUtf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t size = characterSize(text);
    if (size == 0) return false;
    text.remove_prefix(size);
  }
  return true;
}

std::string fromLatin1(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      text += c;
    } else {
      text += static_cast<char>(0xC0 | byte >> 6);
      text += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return text;
}

std::string excerpt(std::string_view text) {
  std::string shown(text.substr(0, 60));
  while (!shown.empty() && !isUtf8(shown)) shown.pop_back();
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return shown.size() < text.size() ? shown + "..." : shown;
}

}  // namespace lodeline

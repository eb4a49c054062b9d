#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "lodeline/io/tables/byte_source.h"

namespace lodeline {

/// Reads a text line by line as valid UTF-8. Lines end with LF, CRLF or CR. A line that is not UTF-8 is read
/// as Latin-1. Memory use does not depend on the length of the text: of a line longer than kLongestLine, only
/// that many bytes are kept.
class TextLines {
 public:
  static constexpr std::size_t kLongestLine = 1 << 20;

  /// `name` is for messages. Throws InputError where the bytes are not text.
  TextLines(std::unique_ptr<ByteSource> bytes, const std::string& name);

  /// Reads the next line without its line end; returns false after the last one. `line` is valid until the
  /// next call.
  bool next(std::string_view* line);

  int number() const { return number_; }  ///< number of the line, counted from 1
  std::size_t bytesRead() const { return bytes_filled_ - (end_ - begin_); }  ///< as UTF-8
  bool wasTooLong() const { return was_too_long_; }
  bool hadNoEnd() const { return had_no_end_; }  ///< the text ends within this line, so it may be truncated

 private:
  bool fill();
  void keep(std::string_view part);

  std::unique_ptr<ByteSource> bytes_;
  std::string buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< range of buffer_ that was not returned yet
  std::string line_;
  std::size_t bytes_filled_ = 0;  ///< into buffer_ since the start
  int number_ = 0;
  bool was_too_long_ = false;
  bool had_no_end_ = false;
  bool skip_line_feed_ = false;  ///< the line before ended with CR: an LF now belongs to that line end
};

/// True where `text` is valid UTF-8.
bool isUtf8(std::string_view text);

/// Converts each byte to the Unicode character with that number.
std::string fromLatin1(std::string_view bytes);

/// Text for messages: at most 60 bytes, control characters replaced by '?'.
std::string excerpt(std::string_view text);

}  // namespace lodeline

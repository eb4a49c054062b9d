#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "lodeline/io/tables/byte_source.h"

namespace lodeline {

/// The lines of a text, one at a time, in valid UTF-8. Lines end with LF, CRLF or CR. A line that is no UTF-8
/// is taken for Latin-1. Memory does not grow with the text: of a line longer than kLongestLine only that
/// much is kept.
class TextLines {
 public:
  static constexpr std::size_t kLongestLine = 1 << 20;

  /// `name` is for messages. Throws InputError where the bytes are no text.
  TextLines(std::unique_ptr<ByteSource> bytes, const std::string& name);

  /// The next line without its end; false after the last one. `line` is valid until the next call.
  bool next(std::string_view* line);

  int number() const { return number_; }  ///< of the line, counted from 1
  bool wasTooLong() const { return was_too_long_; }
  bool hadNoEnd() const { return had_no_end_; }  ///< the text ends within this line: it may be cut off

 private:
  bool fill();
  void keep(std::string_view part);

  std::unique_ptr<ByteSource> bytes_;
  std::string buffer_;
  std::size_t begin_ = 0, end_ = 0;  ///< the part of buffer_ that is yet to be given out
  std::string line_;
  int number_ = 0;
  bool was_too_long_ = false;
  bool had_no_end_ = false;
  bool skip_line_feed_ = false;  ///< the line before ended with CR: an LF now is part of its end
};

/// True where `text` is valid UTF-8.
bool isUtf8(std::string_view text);

/// Each byte as the character of that number.
std::string fromLatin1(std::string_view bytes);

/// For messages: at most 60 bytes, control characters as '?'.
std::string excerpt(std::string_view text);

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/util/time/time.h"

namespace lodeline {

/// One line of a text file with its fields, and where it stands for messages.
struct TextLine {
  int number = 0;                   ///< counted from 1
  std::vector<std::string> fields;  ///< separated by blanks, tabs, commas or semicolons
};

/// A text file of columns (TextLines): blank lines and lines that start with '#' are left out. Everything a
/// reader of poses needs to name file and line.
struct TextTable {
  std::filesystem::path path;
  std::vector<TextLine> lines;

  std::string where(const TextLine& line) const;

  /// Field `column` (from 0) as a number; NaN and infinity are passed on, text that is not a number throws
  /// InputError.
  double number(const TextLine& line, std::size_t column) const;

  /// Field `column` as a time in seconds, whatever its notation, exact to 1 ns. Throws InputError.
  Time timeInSeconds(const TextLine& line, std::size_t column) const;

  /// Field `column` as integer nanoseconds. Throws InputError.
  Time timeInNanoseconds(const TextLine& line, std::size_t column) const;
};

/// Reads a whole file, plain or compressed with gzip. Throws InputError when it is missing, is a folder or
/// its compression is damaged.
std::string readFileBytes(const std::filesystem::path& path);

/// Throws InputError as readFileBytes does, and when the file has no line with data.
TextTable readTextTable(const std::filesystem::path& path);

/// Seconds written as decimal text ("1403715529.112143517", "1.4e+09") as a time; false when it is no number
/// or does not fit.
bool parseSeconds(std::string_view text, Time& time);

/// True when the text consists of digits only.
bool isInteger(std::string_view text);

}  // namespace lodeline

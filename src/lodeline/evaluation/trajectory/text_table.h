#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// One line of a text file with its fields, and its number for messages.
struct TextLine {
  int number = 0;                   ///< counted from 1
  std::vector<std::string> fields;  ///< separated by blanks, tabs, commas or semicolons
};

/// A text file of columns (TextLines), without blank lines and lines that start with '#'. It contains
/// everything that a reader of poses needs to name file and line.
struct TextTable {
  std::filesystem::path path;
  std::vector<TextLine> lines;

  std::string where(const TextLine& line) const;

  /// Field `column` (from 0) as a number, including NaN and infinity. Throws InputError where the text is not
  /// a number.
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

/// Converts seconds in decimal text ("1403715529.112143517", "1.4e+09") to a time; returns false when it is
/// not a number or out of range.
bool parseSeconds(std::string_view text, Time& time);

/// True when the text consists of digits only.
bool isInteger(std::string_view text);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The cells of one line of a table.
namespace lodeline {

/// What stands between cells. Blanks: any run of blanks and tabs. CommasAndBlanks: such a run, or a comma
/// with or without blanks about it.
enum class Separator { Comma, Semicolon, Tab, Blanks, CommasAndBlanks };

inline bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Without the blanks, tabs and no-break spaces at both ends.
std::string_view trimmed(std::string_view text);

/// The separator that the line itself suggests: semicolons before tabs before commas before blanks, each
/// outside of quotes. Commas between digits of a line of blanks are decimal commas; a line of numbers may
/// have commas and blanks.
Separator separatorOf(std::string_view line);

/// The cells of `line`, trimmed and without their quotes. A doubled quote within quotes stands for one. The
/// views are into `line` or, where quotes had to be taken out of a cell, into `unquoted`.
void splitCells(std::string_view line, Separator separator, std::vector<std::string_view>* cells,
                std::vector<std::string>* unquoted);

/// A number and nothing else, NaN and infinity included; one comma may be the decimal mark ("0,25", and with
/// groups of thousands "1.234,5" or "1,234.5").
std::optional<double> numberFrom(std::string_view cell);

/// The cell with a decimal point and an ASCII minus sign, where it is a number as numberFrom reads it; for
/// what must keep all digits, such as stamps. Any other cell is returned as it is.
std::string withDecimalPoint(std::string_view cell);

}  // namespace lodeline

#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Functions that split one line of a table into cells.
namespace lodeline {

/// Separator between cells. Blanks: any run of blanks and tabs. CommasAndBlanks: such a run, or a comma with
/// or without blanks around it.
enum class Separator { Comma, Semicolon, Tab, Blanks, CommasAndBlanks };

inline bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// `text` without blanks, tabs and no-break spaces at both ends.
std::string_view trimmed(std::string_view text);

/// The separator that a line uses: semicolons before tabs before commas before blanks, each outside quotes.
/// Commas between digits in a line of blanks are decimal commas. A line of numbers may have both commas and
/// blanks.
Separator separatorOf(std::string_view line);

/// Splits `line` into cells, trimmed and without their quotes. A doubled quote within quotes is one quote
/// character. The views refer to `line`, or to `unquoted` where quotes were removed from a cell.
void splitCells(std::string_view line, Separator separator, std::vector<std::string_view>* cells,
                std::vector<std::string>* unquoted);

/// Parses all of a cell as a number, including NaN and infinity. One comma may be the decimal mark ("0,25",
/// and with groups of thousands "1.234,5" or "1,234.5").
std::optional<double> numberFrom(std::string_view cell);

/// A numeric cell (see numberFrom) with a decimal point and an ASCII minus sign, for values that must keep
/// all their digits, such as stamps. Any other cell is returned unchanged.
std::string withDecimalPoint(std::string_view cell);

}  // namespace lodeline

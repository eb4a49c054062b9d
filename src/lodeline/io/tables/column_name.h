#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace lodeline {

/// A column name of a header, split into words and unit.
struct ColumnName {
  ColumnName() = default;
  /// `header`: one cell of a header, such as `"Magnetic field x (µT)"`, `gyro_rad[0]`,
  /// `field.pose.position.x`.
  explicit ColumnName(std::string_view header);

  /// Whether one of the words is among `wanted` (lower case).
  bool hasWord(std::initializer_list<std::string_view> wanted) const;
  /// Whether one of the words begins with one of `stems`.
  bool hasStem(std::initializer_list<std::string_view> stems) const;

  std::string text;                   ///< as written
  std::vector<std::string> words;     ///< lower case, without the unit in brackets: "GyrX" has "gyr", "x"
  std::string unit;                   ///< in brackets, parentheses or after "in", as written; may be empty
  std::vector<std::string> suffixes;  ///< possible units at the end of the name, longest first
};

}  // namespace lodeline

#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/io/tables/table_reader.h"
#include "lodeline/io/tables/time_columns.h"
#include "lodeline/types.h"

namespace lodeline {

/// All rows of a table of poses as numbers, with the text of their times.
class PoseRows {
 public:
  /// Throws InputError where there are no rows, or rows with different numbers of columns. With
  /// `ignores_header` a header is skipped.
  PoseRows(std::unique_ptr<ByteSource> bytes, std::string name, bool ignores_header,
           Diagnostics& diagnostics);

  const std::string& name() const { return name_; }
  /// Columns of a header with a time, a position and a quaternion; else empty.
  const std::vector<ColumnName>& columns() const { return columns_; }
  const std::vector<std::string>& preamble() const { return preamble_; }
  /// A header that names no pose; empty where there is none.
  const std::string& unknownHeader() const { return unknown_header_; }
  std::size_t columnCount() const { return column_count_; }
  std::size_t size() const { return lines_.size(); }
  std::string where(std::size_t row) const;

  /// Throws InputError where the cell is not a number.
  double number(std::size_t row, std::size_t column) const;
  /// The 3x4 matrix that starts at a column, row by row, completed by (0, 0, 0, 1).
  Eigen::Matrix4d matrix(std::size_t row, std::size_t first_column) const;

  /// Whether the numbers from a column on are valid matrices or quaternions in nine of ten finite rows.
  bool areMatrices(std::size_t first_column) const;
  bool areQuaternions(std::size_t first_column) const;

  /// Whether the first column contains Unix times in nanoseconds, or its name states nanoseconds.
  bool timesAreNanoseconds() const;
  bool timesHaveDecimals() const;
  bool hasSeparators() const { return has_separators_; }  ///< rather than blanks

  TimeUnit timeUnit(const TimeColumn& column, Diagnostics& diagnostics) const;
  /// Throws InputError where the cell is not a time.
  Time time(std::size_t row, const TimeColumn& column, TimeUnit unit) const;

 private:
  /// Number of stored columns; poses and matrices come before further ones.
  static constexpr std::size_t kMostNumbers = 64;

  void keep(const TableReader& table);
  double value(std::size_t row, std::size_t column) const { return numbers_[row * kept_columns_ + column]; }
  std::string timeText(std::size_t row, std::size_t column) const;

  std::string name_;
  std::vector<ColumnName> columns_;
  std::vector<std::string> preamble_;
  std::string unknown_header_;
  std::size_t column_count_ = 0;
  std::size_t kept_columns_ = 0;
  bool has_separators_ = false;
  std::vector<double> numbers_;          ///< row by row; NaN where a cell is not a number
  std::vector<int> lines_;               ///< of each row in the file
  std::vector<std::size_t> times_;       ///< columns that may be times
  std::vector<std::string> time_texts_;  ///< of each row, those of times_
  std::map<std::pair<std::size_t, std::size_t>, std::string> no_numbers_;  ///< cells that are no number
};

}  // namespace lodeline

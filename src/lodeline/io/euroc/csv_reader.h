#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/csv/sensor_columns.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/types.h"

namespace lodeline {

/// One row of a sensor's CSV file: a stamp, numbers in SI units, and an optional text column.
struct CsvRow {
  Time time;
  std::vector<double> numbers;
  std::string text;  ///< the first field after the numbers, trimmed; empty where there is none
};

/// Content of a row after its stamp, in the order of CsvRow::numbers.
enum class CsvContent {
  Images,        ///< no numbers; the name of the image file
  Imu,           ///< angular velocity x y z (rad/s), specific force x y z (m/s^2)
  Magnetometer,  ///< field x y z (T)
  Depth,         ///< depth (m), positive down
  Sonar,         ///< range (m), angle (rad)
  Altimeter,     ///< range (m)
  TruePose,      ///< position x y z (m), quaternion w x y z
};

/// A column of numbers that was found by its name.
struct CsvColumn {
  std::size_t column = 0;
  double to_si = 1.0;
  bool may_be_missing = false;  ///< an empty cell, or one without a finite number, is then NaN
};

/// Columns that a caller found in a header, in the order of CsvRow::numbers.
struct CsvColumns {
  std::vector<CsvColumn> numbers;
  std::optional<std::size_t> text;
};

/// A table whose header decides how many numbers a row has.
struct CsvLayout {
  std::size_t least_columns = 1;  ///< beside the stamp
  /// Throws InputError where the header lacks a column or states an unknown unit.
  std::function<CsvColumns(const std::vector<ColumnName>&)> find;
  std::string expected_header;  ///< for the message about a file without a header
};

/// SI units per unit of a column. Throws InputError, beginning with `file`, for a unit of another quantity.
double unitFactorOf(const std::filesystem::path& file, const StatedUnit& unit, Quantity quantity);

/// Reads a sensor's table (a TableReader) row by row. A header that names the columns defines the column and
/// unit of each quantity. Without such a header, the columns have the order of CsvContent and SI units. A row
/// that cannot be used is reported with file and line and skipped: wrong number of columns, text instead of a
/// number, NaN, or a truncated line.
///
/// Stamps have the unit stated in the header; otherwise they are whole nanoseconds, or seconds with decimals.
/// Where a plausible `rate` is given, the reader checks the first stamps against it. Whole numbers that would
/// give a rate that is far too high are read as microseconds, milliseconds or seconds, which is reported as
/// `stamp_unit`. Decimals that are not seconds are handled likewise.
class CsvReader {
 public:
  /// Throws InputError where the file cannot be opened, is not text, or has a header with other quantities or
  /// an unknown unit. `diagnostics` must outlive the reader.
  CsvReader(const std::filesystem::path& file, CsvContent content, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});
  CsvReader(std::unique_ptr<ByteSource> bytes, const std::filesystem::path& file, CsvContent content,
            Diagnostics* diagnostics);
  /// Reads a table with its header; throws InputError where the header is missing.
  CsvReader(const std::filesystem::path& file, const CsvLayout& layout, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});
  /// Reads `number_count` numbers after the stamp, in the order of the file.
  CsvReader(const std::filesystem::path& file, int number_count, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});

  /// Reads the next usable row in the order of the file; returns false at its end.
  bool next(CsvRow* row);

  const std::filesystem::path& file() const { return file_; }
  int line() const { return table_.line(); }
  /// Share of the file that was read, 0 to 1; nothing for a packed file.
  std::optional<double> shareRead() const;
  const std::vector<ColumnName>& columns() const { return table_.columns(); }  ///< of the header
  /// Reports that the row read last cannot be used.
  void passOver(const std::string& problem) { table_.passOver(problem); }
  /// Text of the stamp in the row read last, as written in the file; valid until the next row is read.
  std::string_view stampText() const { return table_.cell(time_column_); }

 private:
  CsvReader(std::unique_ptr<ByteSource> bytes, std::filesystem::path file, std::size_t number_count,
            Diagnostics* diagnostics);
  void findColumns(CsvContent content);
  void findTimeColumn(const SensorColumns& sensors);
  /// Determines the stamp unit from the first stamps of `ahead`, a reader of the same file.
  void settleStampUnit(CsvReader ahead, PlausibleRate rate, Diagnostics* diagnostics);
  /// Problem of the current row; empty where `row` was filled.
  std::string parseRow(CsvRow* row) const;

  std::filesystem::path file_;
  TableReader table_;
  std::size_t time_column_ = 0;
  std::optional<TimeColumn> two_columns_;  ///< of times in two columns, such as seconds and nanoseconds
  TimeUnit stamp_unit_ = TimeUnit::Nanoseconds;
  std::optional<TimeUnit> decimal_unit_;  ///< of stamps with decimals; nothing if invalid
  std::vector<CsvColumn> numbers_;
  std::size_t text_column_ = 0;
};

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/io/euroc/sensor_columns.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// One row of a sensor's CSV file: a stamp, then numbers in SI units, then perhaps a text column.
struct CsvRow {
  Time time;
  std::vector<double> numbers;
  std::string text;  ///< the first field after the numbers, blanks trimmed; empty where there is none
};

/// What the rows of a sensor's file hold after their stamp, in the order of CsvRow::numbers.
enum class CsvContent {
  Images,        ///< no numbers; the name of the image's file
  Imu,           ///< angular velocity x y z (rad/s), specific force x y z (m/s^2)
  Magnetometer,  ///< field x y z (T)
  Depth,         ///< depth (m), positive down
  Sonar,         ///< range (m), angle (rad)
  TruePose,      ///< position x y z (m), quaternion w x y z
};

/// Reads the table of a sensor (a TableReader) row by row. A header that names the columns says where each
/// quantity stands and in which unit; without one they stand in the order of CsvContent, in SI units. A row
/// that cannot be used (wrong number of columns, no number where one is due, NaN, cut off) is reported with
/// file and line and passed over.
///
/// Stamps are in the unit that the header states, else whole nanoseconds, or seconds with decimals. Where a
/// rate is given that the sensor can have, the first stamps are looked at: whole numbers that would make the
/// sensor far too fast are taken for microseconds, milliseconds or seconds, which is reported as
/// `stamp_unit`; so are decimals that are no seconds.
class CsvReader {
 public:
  /// Throws InputError where the file cannot be opened, is no text, or has a header that names other
  /// quantities or an unknown unit. `diagnostics` must outlive the reader.
  CsvReader(const std::filesystem::path& file, CsvContent content, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});
  CsvReader(std::unique_ptr<ByteSource> bytes, const std::filesystem::path& file, CsvContent content,
            Diagnostics* diagnostics);
  /// `number_count` numbers after the stamp, in the order of the file.
  CsvReader(const std::filesystem::path& file, int number_count, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});

  /// The next usable row in the order of the file; false at its end.
  bool next(CsvRow* row);

  const std::filesystem::path& file() const { return file_; }
  int line() const { return table_.line(); }
  /// The stamp of the row read last, as it stands in the file; valid until the next row is read.
  std::string_view stampText() const { return table_.cell(time_column_); }

 private:
  struct NumberColumn {
    std::size_t column;
    double to_si;
  };

  CsvReader(std::unique_ptr<ByteSource> bytes, std::filesystem::path file, std::size_t number_count,
            Diagnostics* diagnostics);
  void findColumns(CsvContent content);
  void findTimeColumn(const SensorColumns& sensors);
  /// Looks at the first stamps of `ahead`, a reader of the same file.
  void settleStampUnit(CsvReader ahead, PlausibleRate rate, Diagnostics* diagnostics);
  /// What is wrong with the current row, or nothing where it filled `row`.
  std::string parseRow(CsvRow* row) const;

  std::filesystem::path file_;
  TableReader table_;
  std::size_t time_column_ = 0;
  TimeUnit stamp_unit_ = TimeUnit::Nanoseconds;
  std::optional<TimeUnit> decimal_unit_;  ///< of stamps with decimals; nothing where these are no stamps
  std::vector<NumberColumn> numbers_;
  std::size_t text_column_ = 0;
};

}  // namespace lodeline

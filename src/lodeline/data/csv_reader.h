#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/base/time.h"
#include "lodeline/base/time_unit.h"

namespace lodeline {

/// One row of a sensor's CSV file: a stamp, then numbers, then perhaps a text column.
struct CsvRow {
  Time time;
  std::vector<double> numbers;
  std::string text;  ///< the first field after the numbers, blanks trimmed; empty where there is none
};

/// Reads comma-separated rows one at a time, so that memory does not grow with the length of the recording.
/// Lines that start with '#', blank lines, a header without '#' and CRLF line ends are all normal. A row that
/// cannot be used (wrong number of columns, no number where one is due, NaN, cut off) is reported with file
/// and line and passed over.
///
/// Stamps are whole nanoseconds, or seconds with decimals. Where a rate is given that the sensor can have,
/// the first stamps are looked at: whole numbers that would make the sensor far too fast are taken for
/// microseconds, milliseconds or seconds, which is reported as `stamp_unit`; so are decimals that are no
/// seconds.
class CsvReader {
 public:
  /// `number_count`: how many numbers follow the stamp. Throws InputError where the file cannot be opened.
  /// `diagnostics` must outlive the reader.
  CsvReader(std::filesystem::path file, int number_count, Diagnostics* diagnostics,
            std::optional<PlausibleRate> rate = {});

  /// The next usable row in the order of the file; false at its end.
  bool next(CsvRow* row);

  const std::filesystem::path& file() const { return file_; }
  int line() const { return line_number_; }
  /// The stamp of the row read last, as it stands in the file.
  std::string_view stampText() const { return fields_.empty() ? std::string_view() : fields_[0]; }

 private:
  void readHeader(std::string_view header);
  void settleStampUnit(PlausibleRate rate);
  /// What is wrong with the current line, or nothing where it filled `row`.
  std::string parseLine(std::string_view line, CsvRow* row);

  std::filesystem::path file_;
  size_t number_count_;
  size_t column_count_;  ///< that every row must have: of the header where it names them, else the fewest
  Diagnostics* diagnostics_;
  std::ifstream stream_;
  std::string line_;
  std::vector<std::string_view> fields_;
  int line_number_ = 0;
  TimeUnit stamp_unit_ = TimeUnit::Nanoseconds;
  std::optional<TimeUnit> decimal_unit_;  ///< of stamps with decimals; nothing where these are no stamps
};

}  // namespace lodeline

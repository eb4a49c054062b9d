#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "lodeline/io/tables/table_reader.h"
#include "lodeline/io/tables/time_columns.h"
#include "lodeline/io/tables/units.h"
#include "lodeline/types.h"

namespace lodeline {

/// A table of one three-axis sensor that its file name tells, not its header: the columns of a header named
/// x, y, z and a time (time, timestamp; `seconds_elapsed` where no other is there), or without a header x, y,
/// z and a time in ns (OpenCamera Sensors). Numbers are in `usual_unit` unless the header states another one.
class AxisTable {
 public:
  struct Reading {
    Time time;
    Vec3 value;  ///< SI units
  };

  /// Throws InputError where the columns are not as above. `diagnostics` must outlive the reader.
  AxisTable(const std::filesystem::path& file, Quantity quantity, double usual_unit,
            Diagnostics* diagnostics);

  /// The next usable row; others are reported.
  std::optional<Reading> next();

 private:
  void settleColumns(const std::filesystem::path& file, Quantity quantity);

  TableReader table_;
  std::array<std::size_t, 3> axes_ = {0, 1, 2};
  TimeColumn time_;
  TimeUnit unit_ = TimeUnit::Nanoseconds;
  double to_si_;
};

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/robots/dvl_screen.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads dvl0/data.csv, with the velocity of the instrument, or with one row for each beam; the rows of one
/// stamp form a ping:
///
///     #timestamp [ns],v_x,v_y,v_z [m/s],valid
///     #timestamp [ns],beam,velocity [m/s],range [m],valid
///
/// Optional columns are `track` (bottom or water) and `sigma` (m/s, of each axis). A table of beams may have
/// v_x, v_y, v_z and v_valid of the whole ping as well. Beams are counted from 0, or all of them from 1,
/// which is reported as `dvl_beam_numbers`.
class DvlTable {
 public:
  /// `beam_count`: of the calibration. Throws InputError for a file without these columns, and for an unknown
  /// unit.
  DvlTable(const std::filesystem::path& file, size_t beam_count, Diagnostics* diagnostics);
  DvlTable(const DvlTable&) = delete;  // its reader refers to it
  DvlTable& operator=(const DvlTable&) = delete;

  std::optional<DvlSample> next();

 private:
  /// Takes the numbers of the beams as they stand in the file.
  struct AsWritten {};
  DvlTable(AsWritten, const std::filesystem::path& file, size_t beam_count, Diagnostics* diagnostics);

  /// Columns that a table may have, in the order of Row::numbers.
  enum Number : size_t { kVx, kVy, kVz, kVelocityValid, kBeam, kVelocity, kRange, kValid, kSigma, kNumbers };

  CsvColumns findColumns(const std::vector<ColumnName>& columns);
  void addVelocityColumns(const std::vector<ColumnName>& columns, CsvColumns* found);
  void addBeamColumns(const std::vector<ColumnName>& columns, CsvColumns* found);
  std::optional<double> number(Number number) const;
  /// Whether the beams are counted from 1: none of the first rows has beam 0, and one has the last number.
  bool countsFromOne(size_t beam_count);
  StatedDvlPing pingOfRow();
  void addBeam(StatedDvlPing* ping);

  std::filesystem::path file_;
  std::vector<std::optional<size_t>> places_;  ///< by Number, the place in the row
  CsvReader reader_;
  CsvRow row_;
  bool has_row_ = false;  ///< whether row_ belongs to the next ping
  int first_beam_ = 0;
  DvlScreen screen_;
};

}  // namespace lodeline

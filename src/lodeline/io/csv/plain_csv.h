#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/csv/sensor_columns.h"
#include "lodeline/io/tables/counter_wrap.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/rig.h"

namespace lodeline {

/// One row in SI units; sensors that the file does not have are empty.
struct PlainReading {
  Time time;
  std::optional<Vec3> angular_velocity;  ///< rad/s
  std::optional<Vec3> specific_force;    ///< m/s^2
  std::optional<Vec3> field;             ///< T; also empty where only this row has no value
};

/// Caller's choices for properties that a table does not define.
struct PlainCsvOptions {
  /// The table belongs to a magnetometer. Columns x, y, z without a sensor name then hold the field. It keeps
  /// its numbers where no unit is stated. Times may be missing.
  bool is_magnetometer = false;
  /// Quantity of columns x, y, z without a sensor name, where the name of the file states it.
  std::optional<Quantity> bare_columns = std::nullopt;
  /// Tesla per unit of a field without a stated unit, where the documentation of the program states it.
  std::optional<double> field_unit_T = std::nullopt;
};

/// Reads a single table (TableReader) row by row. It has a time and readings of gyroscope, accelerometer and
/// magnetometer, all at one rate.
///
/// The header names the columns (SensorColumns) and may state units: `t [s], wx [deg/s], …, MagX (µT)`.
/// Without a header, each row must have a time and 3 (magnetometer), 6 (gyroscope, accelerometer) or 9
/// numbers (all). Rows `Raw:ax,ay,az,gx,gy,gz,mx,my,mz` of calibration programs are also accepted; only their
/// magnetometer is used.
///
/// Without a unit, a time with a decimal point is in seconds and a whole number in nanoseconds. Another unit
/// counts where it alone gives a plausible sensor rate, or for the current time in steps of 100 ns. Whole
/// numbers are refused where nanoseconds would mean an unusually fast sensor. The gyroscope is in rad/s.
/// Accelerometer and magnetometer have the unit for which the median of the first readings is plausible on
/// Earth. Units other than SI are reported.
class PlainCsv {
 public:
  /// Throws InputError where the file cannot be opened, has no usable row, or has a header that cannot be
  /// interpreted. `diagnostics` must outlive the reader.
  PlainCsv(const std::filesystem::path& file, Diagnostics* diagnostics, const PlainCsvOptions& options = {});
  PlainCsv(std::unique_ptr<ByteSource> bytes, std::string name, Diagnostics* diagnostics,
           const PlainCsvOptions& options = {});

  /// Reads the next usable row; returns false at the end. Rows with missing, additional or non-finite numbers
  /// are reported with file and line and skipped.
  bool next(PlainReading* reading);

  bool hasGyroscope() const { return gyroscope_.has_value(); }
  bool hasAccelerometer() const { return accelerometer_.has_value(); }
  bool hasMagnetometer() const { return magnetometer_.has_value(); }
  bool hasTimes() const { return time_.has_value(); }  ///< false: readings get stamps 10 ms apart
  /// Whether the field is relative to that at the place of the maker's calibration, without a unit.
  bool hasRelativeField() const { return has_relative_field_; }
  bool statesFieldUnit() const { return magnetometer_ && magnetometer_->unit.factor.has_value(); }

 private:
  /// Columns of one three-axis sensor.
  struct Triad : TriadColumns {
    double to_si = 1.0;
  };
  /// A row read in advance to determine the units.
  struct Row {
    std::vector<std::string> cells;
    int line = 0;
  };
  /// A unit, and the plausible magnitudes of a reading on Earth in this unit.
  struct UnitGuess {
    const char* name;
    double to_si;
    double least, most;
  };
  static const std::array<UnitGuess, 3> kForceGuesses;
  static const std::array<UnitGuess, 5> kFieldGuesses;

  void findColumns();
  void takeBareColumns(const TriadColumns& columns);
  void assumeColumns();
  void requireKnownUnits(Quantity quantity, const std::optional<Triad>& triad) const;
  void readFirstRows();
  void settleTime();
  void settleTimeUnit();
  void refuseUnclearUnit(const std::vector<double>& stamps, PlausibleRate rate) const;
  void settleUnits();
  void guessUnit(std::span<const UnitGuess> guesses, const char* what, Triad* triad);
  bool nextRow();
  std::optional<Vec3> valueOf(const Triad& triad, const Row& row) const;
  std::optional<Time> timeOf(const TimeColumn& time, const Row& row) const;
  Time continued(Time time);
  std::string parseRow(PlainReading* reading);

  std::string name_;
  PlainCsvOptions options_;
  Diagnostics* diagnostics_;
  TableReader table_;
  std::vector<TimeColumn> times_;  ///< time columns named in the header
  std::optional<TimeColumn> time_;
  CounterWrap wrap_;
  std::optional<Triad> gyroscope_, accelerometer_, magnetometer_;
  bool has_relative_field_ = false;
  std::optional<std::size_t> instance_column_;
  std::string instance_;   ///< instance of the sensor whose rows are used
  std::deque<Row> first_;  ///< rows read in advance, not yet returned
  Row row_;
  int64_t row_count_ = 0;
};

}  // namespace lodeline

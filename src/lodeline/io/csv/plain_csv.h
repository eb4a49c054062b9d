#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/io/euroc/sensor_columns.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// One row, in SI units; sensors that the file does not have are empty.
struct PlainReading {
  Time time;
  std::optional<Vec3> angular_velocity;  ///< rad/s
  std::optional<Vec3> specific_force;    ///< m/s^2
  std::optional<Vec3> field;             ///< T; also missing where only this row has none
};

/// What the caller of PlainCsv makes of what a table leaves open.
struct PlainCsvOptions {
  /// The table is a magnetometer's: columns x, y, z that tell no sensor are its, the field keeps its numbers
  /// where no unit is stated, and times may be missing.
  bool is_magnetometer = false;
};

/// Reads a single table (TableReader) with a time and the readings of gyroscope, accelerometer, magnetometer,
/// all at one rate, row by row.
///
/// The header names the columns (SensorColumns) and may state units: `t [s], wx [deg/s], …, MagX (µT)`.
/// Without a header there must be a time and 3 (magnetometer), 6 (gyroscope, accelerometer) or 9 numbers
/// (all), or rows `Raw:ax,ay,az,gx,gy,gz,mx,my,mz` as calibration programs send them (the magnetometer is
/// used).
///
/// Without a unit, a time with a decimal point is in seconds and a whole number in nanoseconds, unless only
/// another unit gives a rate that a sensor can have; the gyroscope is in rad/s; accelerometer and
/// magnetometer are in the unit that makes the median of the first readings plausible on Earth. What is not
/// the SI unit is reported.
class PlainCsv {
 public:
  /// Throws InputError where the file cannot be opened, has no usable row, or has a header that cannot be
  /// understood. `diagnostics` must outlive the reader.
  PlainCsv(const std::filesystem::path& file, Diagnostics* diagnostics, const PlainCsvOptions& options = {});
  PlainCsv(std::unique_ptr<ByteSource> bytes, std::string name, Diagnostics* diagnostics,
           const PlainCsvOptions& options = {});

  /// The next usable row; false at the end. Rows with missing, odd or non-finite numbers are reported with
  /// file and line, and passed over.
  bool next(PlainReading* reading);

  bool hasGyroscope() const { return gyroscope_.has_value(); }
  bool hasAccelerometer() const { return accelerometer_.has_value(); }
  bool hasMagnetometer() const { return magnetometer_.has_value(); }
  bool hasTimes() const { return time_.has_value(); }  ///< else one reading each 10 ms
  bool statesFieldUnit() const { return magnetometer_ && magnetometer_->unit.factor.has_value(); }

 private:
  /// The columns of one sensor.
  struct Triad : TriadColumns {
    double to_si = 1.0;
  };
  /// A row that was read to decide on units.
  struct Row {
    std::vector<std::string> cells;
    int line = 0;
  };
  /// A unit, and the sizes of a reading on Earth in it.
  struct UnitGuess {
    const char* name;
    double to_si;
    double least, most;
  };
  static const std::array<UnitGuess, 3> kForceGuesses;
  static const std::array<UnitGuess, 5> kFieldGuesses;

  void findColumns();
  void assumeColumns();
  void requireKnownUnits(Quantity quantity, const std::optional<Triad>& triad) const;
  void readFirstRows();
  void settleTime();
  void settleTimeUnit();
  void settleUnits();
  void guessUnit(std::span<const UnitGuess> guesses, const char* what, Triad* triad);
  bool nextRow();
  std::optional<Vec3> valueOf(const Triad& triad, const Row& row) const;
  std::optional<Time> timeOf(const TimeColumn& time, const Row& row) const;
  std::string parseRow(PlainReading* reading) const;

  std::string name_;
  PlainCsvOptions options_;
  Diagnostics* diagnostics_;
  TableReader table_;
  std::vector<TimeColumn> times_;  ///< those that the header names
  std::optional<TimeColumn> time_;
  std::optional<Triad> gyroscope_, accelerometer_, magnetometer_;
  std::optional<std::size_t> instance_column_;
  std::string instance_;   ///< whose rows are used
  std::deque<Row> first_;  ///< read already, yet to be given out
  Row row_;
  int64_t row_count_ = 0;
};

}  // namespace lodeline

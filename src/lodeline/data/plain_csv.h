#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/base/diagnostics.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// One row, in SI units; sensors that the file does not have are empty.
struct PlainReading {
  Time time;
  std::optional<Vec3> angular_velocity;  ///< rad/s
  std::optional<Vec3> specific_force;    ///< m/s^2
  std::optional<Vec3> field;             ///< T; also missing where only this row has none
};

/// Reads a single CSV file with a time and the readings of gyroscope, accelerometer, magnetometer, all at one
/// rate, row by row.
///
/// The header names the columns; units stand in brackets: `t [s], wx [deg/s], wy [deg/s], … , mx [uT]`. A
/// name says what it is by its beginning: t, time, stamp; w, g, gyr, ang: gyroscope; a, acc, f:
/// accelerometer; m, mag, b: magnetometer; and x, y, z by the letter at its end. Other columns are passed
/// over. Without a header there must be a time and 3 (magnetometer), 6 (gyroscope, accelerometer) or 9
/// numbers (all).
///
/// Without a unit, a time with a decimal point is in seconds, a whole number in nanoseconds; the gyroscope is
/// in rad/s; accelerometer and magnetometer are in the unit that makes the first reading plausible on Earth,
/// which is reported unless that is SI.
class PlainCsv {
 public:
  /// Throws InputError where the file cannot be opened, has no usable row, or has a header that cannot be
  /// understood. `diagnostics` must outlive the reader.
  PlainCsv(std::filesystem::path file, Diagnostics* diagnostics);

  /// The next usable row; false at the end. Rows with missing, odd or non-finite numbers are reported with
  /// file and line, and passed over.
  bool next(PlainReading* reading);

  bool hasGyroscope() const { return gyroscope_.isThere(); }
  bool hasAccelerometer() const { return accelerometer_.isThere(); }
  bool hasMagnetometer() const { return magnetometer_.isThere(); }

 private:
  /// The columns of one sensor.
  struct Triad {
    int column[3] = {-1, -1, -1};
    double to_si = 0.0;  ///< 0: not known yet
    bool isThere() const { return column[0] >= 0 && column[1] >= 0 && column[2] >= 0; }
  };

  bool nextLine();
  void readHeader(std::string_view header);
  void assumeColumns();
  void guessUnits();
  Vec3 valueOf(const Triad& triad, bool* is_good) const;
  std::string parseFields(PlainReading* reading) const;

  std::filesystem::path file_;
  Diagnostics* diagnostics_;
  std::ifstream stream_;
  std::string line_;
  std::vector<std::string_view> fields_;
  int line_number_ = 0;
  size_t column_count_ = 0;
  int time_column_ = 0;
  double time_to_s_ = 0.0;  ///< 0: seconds with a decimal point, else nanoseconds
  Triad gyroscope_, accelerometer_, magnetometer_;
  bool holds_line_ = false;  ///< line_ is yet to be given out
};

}  // namespace lodeline

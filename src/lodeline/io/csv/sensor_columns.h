#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/tables/time_columns.h"
#include "lodeline/io/tables/units.h"

namespace lodeline {

/// Columns of the three axes of one sensor.
struct TriadColumns {
  std::array<std::size_t, 3> column = {};  ///< of x, y, z
  StatedUnit unit;
  std::string name;  ///< the three names as written in the header, for messages
};

/// Content of the columns of a table of sensor readings, determined from their names.
struct SensorColumns {
  std::vector<TimeColumn> times;  ///< all time columns, best first
  std::optional<TriadColumns> angular_rate, specific_force, field;
  /// Columns x, y and z whose names and units identify no sensor.
  std::optional<TriadColumns> unnamed;
  /// Column with the number of the sensor, in tables with rows of several sensors.
  std::optional<std::size_t> instance;
  /// Whether the field is in units of that at the place of the maker's calibration (Xsens).
  bool has_relative_field = false;
  /// Names of redundant triads, whose quantity is already in another triad.
  std::vector<std::string> unused;
};

/// Identifies columns by the meaning of their names. An axis is a word x, y or z, the last letter (`gx`,
/// `MagY`), or an index (`[0]`). A word (`gyro`, `acc`, `mag`, `angular velocity`, ...), a letter (w, g; a,
/// f; m, b) or the unit (`X (µT)`) identifies the sensor. Biases, offsets, covariances, gravity and
/// accelerations without gravity do not count as readings.
SensorColumns findSensorColumns(const std::vector<ColumnName>& columns);

/// The sensor that the words of a name state, such as the name of a file: "Gyroscope", "TotalAcceleration".
std::optional<Quantity> quantityOfName(const ColumnName& name);

}  // namespace lodeline

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/tables/time_columns.h"
#include "lodeline/io/tables/units.h"

namespace lodeline {

/// The columns of one sensor's three axes.
struct TriadColumns {
  std::array<std::size_t, 3> column = {};  ///< of x, y, z
  StatedUnit unit;
  std::string name;  ///< the three names as the header writes them, for messages
};

/// What the columns of a table of sensor readings hold, by their names.
struct SensorColumns {
  std::vector<TimeColumn> times;  ///< all that name a time, best first
  std::optional<TriadColumns> angular_rate, specific_force, field;
  /// x, y and z whose names and units tell no sensor.
  std::optional<TriadColumns> unnamed;
  /// The number of the sensor, in tables that hold the rows of several.
  std::optional<std::size_t> instance;
  /// Triads of a quantity that has another one, by their names.
  std::vector<std::string> unused;
};

/// Matches names by their meaning. An axis is a word x, y or z, the last letter (`gx`, `MagY`), or an index
/// (`[0]`). The sensor is told by a word (`gyro`, `acc`, `mag`, `angular velocity`, ...), by a letter (w, g;
/// a, f; m, b), or by the unit (`X (µT)`). Biases, offsets, covariances, gravity and accelerations without
/// gravity are no readings.
SensorColumns findSensorColumns(const std::vector<ColumnName>& columns);

}  // namespace lodeline

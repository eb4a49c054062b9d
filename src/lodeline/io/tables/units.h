#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lodeline/io/tables/column_name.h"

namespace lodeline {

/// Quantity measured in a column of numbers. For times, see util/time/time_unit.h.
enum class Quantity { Length, AngularRate, SpecificForce, MagneticField, Velocity, Current };

/// "length", "angular rate", "specific force", "magnetic field", "velocity", "electric current".
const char* toString(Quantity quantity);

/// SI units per named unit ("uT": 1e-6), for any case and notation ("deg/s", "°/s", "dps"). Returns nothing
/// where the name is not a unit of the quantity. The character '?' (lost by an encoding) matches any
/// character if only one unit fits.
std::optional<double> unitFactor(Quantity quantity, std::string_view unit);

/// The names that unitFactor knows, for messages.
std::string knownUnits(Quantity quantity);

/// The unit stated in a column's name.
struct StatedUnit {
  std::optional<double> factor;  ///< SI units per unit; nothing where the unit is missing or unknown
  std::string text;              ///< as written; empty where the unit is missing
  bool isUnknown() const { return !text.empty() && !factor; }
};

/// The unit of a column with that quantity. It is in brackets or parentheses (`[deg/s]`, `(m/s^2)`), after
/// "in" (`depth in ft`), or at the end of the name (`mag_ut`, `fieldNT`, `accelerometer_m_s2`).
StatedUnit statedUnit(const ColumnName& column, Quantity quantity);

}  // namespace lodeline

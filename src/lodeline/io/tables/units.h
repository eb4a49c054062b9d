#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lodeline/io/tables/column_name.h"

namespace lodeline {

/// What a column of numbers measures. Times have base/time_unit.h.
enum class Quantity { Length, AngularRate, SpecificForce, MagneticField };

/// "length", "angular rate", "specific force", "magnetic field".
const char* toString(Quantity quantity);

/// SI units per unit named so ("uT": 1e-6), whatever its case and notation ("deg/s", "°/s", "dps").
/// Nothing where the name is no unit of the quantity. A character that an encoding lost ('?') stands for any,
/// as long as one unit only fits.
std::optional<double> unitFactor(Quantity quantity, std::string_view unit);

/// The names that unitFactor knows, for messages.
std::string knownUnits(Quantity quantity);

/// What a column's name says about its unit.
struct StatedUnit {
  std::optional<double> factor;  ///< SI units per unit; nothing where none is stated or it is not known
  std::string text;              ///< as written; empty where none is stated
  bool isUnknown() const { return !text.empty() && !factor; }
};

/// The unit of a column of that quantity: in brackets or parentheses (`[deg/s]`, `(m/s^2)`), after "in"
/// (`depth in ft`), or at the end of the name (`mag_ut`, `fieldNT`, `accelerometer_m_s2`).
StatedUnit statedUnit(const ColumnName& column, Quantity quantity);

}  // namespace lodeline

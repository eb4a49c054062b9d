#include "lodeline/io/tables/units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "lodeline/io/tables/cells.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

struct Unit {
  std::string_view name;  ///< as normalized
  double to_si;
};

constexpr double kGravity = 9.80665;
constexpr double kFoot = 0.3048;
constexpr double kKnot = 1852.0 / 3600.0;

constexpr Unit kLengths[] = {{"m", 1.0},
                             {"cm", 1e-2},
                             {"mm", 1e-3},
                             {"ft", kFoot},
                             {"km", 1e3},
                             {"dm", 1e-1},
                             {"metres", 1.0},
                             {"meters", 1.0},
                             {"metre", 1.0},
                             {"meter", 1.0},
                             {"feet", kFoot},
                             {"foot", kFoot},
                             {"centimetres", 1e-2},
                             {"centimeters", 1e-2},
                             {"millimetres", 1e-3},
                             {"millimeters", 1e-3}};
constexpr Unit kRates[] = {{"rad/s", 1.0},
                           {"deg/s", kDegree},
                           {"dps", kDegree},
                           {"mdps", 1e-3 * kDegree},
                           {"mrad/s", 1e-3},
                           {"deg/h", kDegree / 3600.0},
                           {"rpm", 2.0 * M_PI / 60.0},
                           {"rev/min", 2.0 * M_PI / 60.0},
                           {"r/min", 2.0 * M_PI / 60.0},
                           {"rad/sec", 1.0},
                           {"deg/sec", kDegree},
                           {"degrees/s", kDegree},
                           {"degree/s", kDegree},
                           {"rads", 1.0},
                           {"degs", kDegree},
                           {"radps", 1.0},
                           {"degps", kDegree},
                           {"radian/s", 1.0},
                           {"radians/s", 1.0},
                           {"degrees/second", kDegree},
                           {"radians/second", 1.0}};
constexpr Unit kForces[] = {
    {"m/s^2", 1.0},   {"m/s2", 1.0},   {"g", kGravity}, {"mg", 1e-3 * kGravity}, {"cm/s^2", 1e-2},
    {"m/s/s", 1.0},   {"m/s**2", 1.0}, {"ms2", 1.0},    {"mps2", 1.0},           {"m/sec^2", 1.0},
    {"gs", kGravity}, {"m/s^-2", 1.0}, {"mss", 1.0},    {"ms^2", 1.0},           {"ug", 1e-6 * kGravity}};
constexpr Unit kFields[] = {
    {"t", 1.0},           {"ut", 1e-6},         {"nt", 1e-9},      {"gauss", 1e-4},      {"g", 1e-4},
    {"mgauss", 1e-7},     {"mg", 1e-7},         {"mt", 1e-3},      {"ga", 1e-4},         {"gs", 1e-4},
    {"mga", 1e-7},        {"mgs", 1e-7},        {"tesla", 1.0},    {"microtesla", 1e-6}, {"nanotesla", 1e-9},
    {"millitesla", 1e-3}, {"milligauss", 1e-7}, {"ugauss", 1e-10}, {"oe", 1e-4},         {"oersted", 1e-4},
    {"a/m", 4e-7 * M_PI}, {"ka/m", 4e-4 * M_PI}};

constexpr Unit kVelocities[] = {{"m/s", 1.0},     {"mm/s", 1e-3},    {"cm/s", 1e-2},     {"km/h", 1.0 / 3.6},
                                {"kn", kKnot},    {"ft/s", kFoot},   {"m/sec", 1.0},     {"mps", 1.0},
                                {"mmps", 1e-3},   {"cmps", 1e-2},    {"kmh", 1.0 / 3.6}, {"kt", kKnot},
                                {"knots", kKnot}, {"metres/s", 1.0}, {"meters/s", 1.0},  {"fps", kFoot}};
constexpr Unit kCurrents[] = {{"a", 1.0},       {"ma", 1e-3},        {"ka", 1e3},          {"ca", 1e-2},
                              {"ua", 1e-6},     {"amp", 1.0},        {"amps", 1.0},        {"ampere", 1.0},
                              {"amperes", 1.0}, {"milliamps", 1e-3}, {"milliampere", 1e-3}};

std::span<const Unit> unitsOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::Length:
      return kLengths;
    case Quantity::AngularRate:
      return kRates;
    case Quantity::SpecificForce:
      return kForces;
    case Quantity::MagneticField:
      return kFields;
    case Quantity::Velocity:
      return kVelocities;
    case Quantity::Current:
      return kCurrents;
  }
  return {};
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  for (std::size_t at = text.find(from); at != std::string_view::npos; at = text.find(from)) {
    result += text.substr(0, at);
    result += to;
    text.remove_prefix(at + from.size());
  }
  result += text;
  return result;
}

struct Sign {
  std::string_view from, to;
};

/// Replacements in this order: UTF-8 misread as Latin-1 and encoded again, non-ASCII signs, exponents.
constexpr Sign kSigns[] = {{"\u00ce\u00bc", "u"}, {"\u00c2", ""},    {"\u00b5", "u"},
                           {"\u03bc", "u"},       {"\u00b0", "deg"}, {"\u00ba", "deg"},
                           {"\u207b", "^-"},      {"\u00b9", "1"},   {"\u00b2", "^2"},
                           {"^-^", "^-"},         {"\u00b7", " "},   {"\u22c5", " "},
                           {"\u2215", "/"},       {"\ufffd", "?"},   {"*s", " s"},
                           {" per ", "/"},        {" s^-1", "/s"},   {" s-1", "/s"},
                           {" s^-2", "/s^2"},     {" s-2", "/s^2"},  {" ", ""}};

/// The unit in lower case without blanks, with signs as ASCII.
std::string normalized(std::string_view unit) {
  std::string text;
  for (const char c : trimmed(unit)) text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const Sign& sign : kSigns) text = replaced(text, sign.from, sign.to);
  return text;
}

bool fits(std::string_view name, std::string_view pattern) {
  return name.size() == pattern.size() && std::equal(name.begin(), name.end(), pattern.begin(),
                                                     [](char a, char b) { return b == '?' || a == b; });
}

/// The factor of the unit, in common spellings, that a text with lost characters may represent.
std::optional<double> unitWithLostCharacters(Quantity quantity, std::string_view pattern) {
  std::optional<double> found;
  const auto consider = [&](std::string_view name, double to_si) {
    if (!fits(name, pattern)) return true;
    if (found && *found != to_si) return false;
    found = to_si;
    return true;
  };
  for (const Unit& unit : unitsOf(quantity)) {
    const std::string written = replaced(replaced(unit.name, "^2", "2"), "deg", "o");  // one sign each
    if (written != unit.name && !consider(written, unit.to_si)) return std::nullopt;
    if (!consider(unit.name, unit.to_si)) return std::nullopt;
  }
  return found;
}

}  // namespace

const char* toString(Quantity quantity) {
  switch (quantity) {
    case Quantity::Length:
      return "length";
    case Quantity::AngularRate:
      return "angular rate";
    case Quantity::SpecificForce:
      return "specific force";
    case Quantity::MagneticField:
      return "magnetic field";
    case Quantity::Velocity:
      return "velocity";
    case Quantity::Current:
      return "electric current";
  }
  return "";
}

std::optional<double> unitFactor(Quantity quantity, std::string_view unit) {
  const std::string name = normalized(unit);
  for (const Unit& known : unitsOf(quantity)) {
    if (known.name == name) return known.to_si;
  }
  const bool has_lost =
      name.find('?') != std::string::npos && name.find_first_not_of("?/") != std::string::npos;
  return has_lost ? unitWithLostCharacters(quantity, name) : std::nullopt;
}

std::string knownUnits(Quantity quantity) {
  std::string names;
  const std::span<const Unit> units = unitsOf(quantity);
  for (const Unit& unit : units.first(std::min<std::size_t>(units.size(), 6))) {
    names += (names.empty() ? "" : ", ") + std::string(unit.name);
  }
  return names;
}

StatedUnit statedUnit(const ColumnName& column, Quantity quantity) {
  if (!column.unit.empty()) return {unitFactor(quantity, column.unit), column.unit};
  // The suffix of a name: one word, or two for a quotient. A single letter after a letter ("ts") is not a
  // unit.
  for (const std::string& suffix : column.suffixes) {
    // In brackets these are angles.
    if (quantity == Quantity::AngularRate && suffix == "rad") return {1.0, suffix};
    if (quantity == Quantity::AngularRate && suffix == "deg") return {kDegree, suffix};
    if (const std::optional<double> factor = unitFactor(quantity, suffix)) return {factor, suffix};
  }
  return {};
}

}  // namespace lodeline

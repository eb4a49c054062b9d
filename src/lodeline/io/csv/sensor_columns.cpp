#include "lodeline/io/csv/sensor_columns.h"

#include <algorithm>
#include <map>

namespace lodeline {
namespace {

/// One axis of one triad.
struct Axis {
  int axis = 0;
  std::string group;   ///< equal for the three axes of a triad
  std::string sensor;  ///< the letters before the axis in the same word: "mag" of "magx"
};

int axisOfLetter(char letter) {
  const std::size_t axis = std::string_view("xyz").find(letter);
  return axis == std::string_view::npos ? -1 : static_cast<int>(axis);
}

constexpr std::array<std::string_view, 19> kJoinedSensors = {
    "w",   "g",     "gyr",  "gyro", "gyros", "omega", "rot", "a",     "f",   "gf",
    "acc", "accel", "accl", "acce", "m",     "b",     "mag", "field", "magn"};

std::optional<Axis> axisOf(const ColumnName& column) {
  const std::vector<std::string>& words = column.words;
  const auto grouped = [&](std::size_t without, int axis, const std::string& sensor) {
    std::string group = sensor;
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (i != without) group += "_" + words[i];
    }
    return Axis{axis, group, sensor};
  };
  for (std::size_t i = words.size(); i-- > 0;) {
    if (words[i].size() == 1 && axisOfLetter(words[i][0]) >= 0)
      return grouped(i, axisOfLetter(words[i][0]), "");
  }
  for (std::size_t i = words.size(); i-- > 0;) {
    const std::string& word = words[i];
    const int axis = axisOfLetter(word.back());
    const std::string stem = word.substr(0, word.size() - 1);
    if (axis < 0 || std::find(kJoinedSensors.begin(), kJoinedSensors.end(), stem) == kJoinedSensors.end())
      continue;
    return grouped(i, axis, stem);
  }
  const bool is_index =
      words.size() >= 2 && words.back().size() == 1 && words.back()[0] >= '0' && words.back()[0] <= '2';
  if (is_index) return grouped(words.size() - 1, words.back()[0] - '0', "");
  return std::nullopt;
}

bool isNoReading(const ColumnName& column) {
  if (column.hasStem({"bias",   "offset", "ofs",      "cov",     "var",     "std",       "sigma",
                      "err",    "noise",  "setpoint", "delta",   "gravity", "magnitude", "position",
                      "orient", "quat",   "euler",    "heading", "jerk",    "scale"})) {
    return true;
  }
  // Accelerations without gravity from a telephone or an attitude filter.
  if (column.hasWord({"user", "free"})) return true;
  return column.hasWord({"b"}) && column.hasWord({"w", "a", "g"});  // EuRoC's biases: b_w_RS_S_x
}

/// The sensor identified by the words of a name; nothing where they contradict each other.
std::optional<Quantity> quantityByWords(const ColumnName& column, const std::string& joined) {
  const auto has = [&](std::initializer_list<std::string_view> words,
                       std::initializer_list<std::string_view> stems) {
    const bool is_joined = std::find(words.begin(), words.end(), joined) != words.end() ||
                           std::any_of(stems.begin(), stems.end(), [&](std::string_view stem) {
                             return !joined.empty() && joined.starts_with(stem);
                           });
    return is_joined || column.hasWord(words) || column.hasStem(stems);
  };
  const std::string_view letter = joined.size() == 1 ? std::string_view(joined) : std::string_view();
  if (letter == "w" || letter == "g") return Quantity::AngularRate;
  if (letter == "a" || letter == "f") return Quantity::SpecificForce;
  if (letter == "m" || letter == "b") return Quantity::MagneticField;
  if (has({}, {"mag", "compass"})) return Quantity::MagneticField;
  if (has({"gf"}, {"acc", "acel", "beschleunigung"})) return Quantity::SpecificForce;
  if (has({"ars"}, {"gyr", "gir", "omega", "drehrate", "winkelgeschw"})) return Quantity::AngularRate;
  if (column.hasWord({"angular", "ang", "rotation", "rot", "rotationrate"})) return Quantity::AngularRate;
  if (column.hasStem({"specificforce"}) || (column.hasWord({"specific"}) && column.hasWord({"force"}))) {
    return Quantity::SpecificForce;
  }
  if (has({"field"}, {}) && !joined.empty()) return Quantity::MagneticField;
  const bool is_rate = column.hasWord({"w", "g"}), is_force = column.hasWord({"a", "f"});
  const bool is_field = column.hasWord({"m", "b"});
  if (is_rate + is_force + is_field != 1) return std::nullopt;
  return is_rate ? Quantity::AngularRate : is_force ? Quantity::SpecificForce : Quantity::MagneticField;
}

/// The sensor identified by a unit that no other sensor has.
std::optional<Quantity> quantityByUnit(const ColumnName& column) {
  std::optional<Quantity> found;
  if (column.unit.empty()) return found;
  for (const Quantity quantity : {Quantity::AngularRate, Quantity::SpecificForce, Quantity::MagneticField}) {
    if (!statedUnit(column, quantity).factor) continue;
    if (found) return std::nullopt;  // "mg": of acceleration or gauss
    found = quantity;
  }
  return found;
}

std::optional<Quantity> quantityOf(const ColumnName& column, const std::string& joined) {
  const std::optional<Quantity> by_words = quantityByWords(column, joined);
  const std::optional<Quantity> by_unit = quantityByUnit(column);
  if (!by_words) return by_unit;
  // "Rotation x (deg)" is an angle; only words for the sensor itself have priority over the unit.
  const bool names_sensor = column.hasStem({"gyr", "acc", "mag"}) || !joined.empty() ||
                            column.hasWord({"w", "g", "a", "f", "m", "b"});
  const bool contradicts = !column.unit.empty() && !statedUnit(column, *by_words).factor;
  if (contradicts && !names_sensor) return by_unit;
  return by_words;
}

/// Axes of one triad, possibly incomplete.
struct Group {
  std::optional<Quantity> quantity;
  std::array<std::optional<std::size_t>, 3> column;
  std::string name;
  bool isComplete() const { return column[0] && column[1] && column[2]; }
};

std::vector<Group> groupsOf(const std::vector<ColumnName>& columns) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> index;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::optional<Axis> axis = axisOf(columns[i]);
    if (!axis || isNoReading(columns[i])) continue;
    const std::optional<Quantity> quantity = quantityOf(columns[i], axis->sensor);
    const std::string key = axis->group + (quantity ? toString(*quantity) : "");
    const auto [at, is_new] = index.emplace(key, groups.size());
    if (is_new) groups.push_back({quantity, {}, {}});
    Group& group = groups[at->second];
    if (group.column[static_cast<std::size_t>(axis->axis)]) continue;  // the first column of a name is used
    group.column[static_cast<std::size_t>(axis->axis)] = i;
    group.name += (group.name.empty() ? "" : ", ") + columns[i].text;
  }
  return groups;
}

bool saysNothing(const ColumnName& column) {
  return std::all_of(column.words.begin(), column.words.end(), [](const std::string& word) {
    return word.size() == 1 || word == "xyz" || word == "axis" || word == "value" || word == "val";
  });
}

}  // namespace

SensorColumns findSensorColumns(const std::vector<ColumnName>& columns) {
  SensorColumns result;
  result.times = findTimeColumns(columns);
  for (const Group& group : groupsOf(columns)) {
    if (!group.isComplete()) continue;
    const ColumnName& first = columns[*group.column[0]];
    TriadColumns triad;
    triad.column = {*group.column[0], *group.column[1], *group.column[2]};
    triad.name = group.name;
    if (group.quantity) triad.unit = statedUnit(first, *group.quantity);
    std::optional<TriadColumns>& place = !group.quantity                              ? result.unnamed
                                         : *group.quantity == Quantity::AngularRate   ? result.angular_rate
                                         : *group.quantity == Quantity::SpecificForce ? result.specific_force
                                                                                      : result.field;
    if (!group.quantity && !saysNothing(first)) continue;
    if (place) {
      result.unused.push_back(group.name);
    } else {
      place = triad;
    }
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::vector<std::string>& words = columns[i].words;
    const bool is_instance = words == std::vector<std::string>{"i"} || columns[i].hasWord({"instance"}) ||
                             words == std::vector<std::string>{"device", "id"};
    if (is_instance && !result.instance) result.instance = i;
    const bool is_xsens = words == std::vector<std::string>{"packet", "counter"} ||
                          words == std::vector<std::string>{"sample", "time", "fine"};
    result.has_relative_field = result.has_relative_field || is_xsens;
  }
  return result;
}

std::optional<Quantity> quantityOfName(const ColumnName& name) { return quantityByWords(name, ""); }

}  // namespace lodeline

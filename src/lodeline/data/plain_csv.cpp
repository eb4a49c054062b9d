#include "lodeline/data/plain_csv.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "lodeline/base/angles.h"
#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"
#include "lodeline/inertial/gravity.h"

namespace lodeline {
namespace {

enum class Quantity { Time, Rate, Force, Field };

struct Unit {
  std::string_view name;  ///< lower case
  double to_si;
};

std::vector<Unit> unitsOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::Time:
      return {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
    case Quantity::Rate:
      return {{"rad/s", 1.0}, {"deg/s", kDegree}, {"dps", kDegree}};
    case Quantity::Force:
      return {{"m/s^2", 1.0}, {"m/s2", 1.0}, {"g", kStandardGravity}, {"mg", 1e-3 * kStandardGravity}};
    case Quantity::Field:
      return {{"t", 1.0},  {"ut", 1e-6},     {"nt", 1e-9}, {"gauss", 1e-4},
              {"g", 1e-4}, {"mgauss", 1e-7}, {"mg", 1e-7}};
  }
  return {};
}

/// A unit by what its quantity is on Earth: the field is 20 to 70 uT, raw readings up to twice as much or
/// half.
struct Guess {
  Unit unit;
  double least, most;
};
constexpr std::array<Guess, 3> kForceGuesses = {{{{"m/s^2", 1.0}, 4.9, 19.7},
                                                 {{"g", kStandardGravity}, 0.5, 2.0},
                                                 {{"mg", 1e-3 * kStandardGravity}, 500.0, 2000.0}}};
constexpr std::array<Guess, 5> kFieldGuesses = {{{{"T", 1.0}, 1e-5, 1.4e-4},
                                                 {{"uT", 1e-6}, 10.0, 140.0},
                                                 {{"gauss", 1e-4}, 0.1, 1.4},
                                                 {{"mgauss", 1e-7}, 140.0, 1400.0},
                                                 {{"nT", 1e-9}, 1e4, 1.4e5}}};

std::string lower(std::string_view text) {
  std::string result;
  for (const char c : text) result += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

void replaceAll(std::string* text, std::string_view from, std::string_view to) {
  for (size_t at = text->find(from); at != std::string::npos; at = text->find(from, at + to.size())) {
    text->replace(at, from.size(), to);
  }
}

/// "wx [rad s^-1]" as name "wx" and unit "rad/s".
struct Column {
  explicit Column(std::string_view header) {
    const size_t open = header.find_first_of("[(");
    name = lower(csv::trimmed(header.substr(0, open)));
    if (open == std::string_view::npos) return;
    const size_t close = header.find_first_of("])", open);
    unit = lower(csv::trimmed(header.substr(open + 1, close - open - 1)));
    for (const auto& [from, to] :
         {std::pair("\u00b5", "u"), std::pair("\u03bc", "u"), std::pair("\u00b0", "deg"),
          std::pair(" s^-1", "/s"), std::pair(" s^-2", "/s^2")}) {
      replaceAll(&unit, from, to);
    }
  }
  bool begins(std::initializer_list<std::string_view> with) const {
    return std::any_of(with.begin(), with.end(), [this](std::string_view w) { return name.starts_with(w); });
  }
  /// 0, 1, 2 by the last letter; -1 for none.
  int axis() const {
    const size_t axis = name.empty() ? std::string_view::npos : std::string_view("xyz").find(name.back());
    return axis == std::string_view::npos ? -1 : static_cast<int>(axis);
  }
  bool isTime() const { return name == "t" || begins({"t_", "time", "stamp"}); }
  /// What the sensor measures that a column with an axis belongs to.
  std::optional<Quantity> quantity() const {
    if (begins({"w", "g", "ang"})) return Quantity::Rate;
    if (begins({"a", "f"})) return Quantity::Force;
    if (begins({"m", "b"})) return Quantity::Field;
    return std::nullopt;
  }
  /// Factor to SI; 0 where no unit is stated, nothing where it is not one of the quantity's.
  std::optional<double> toSi(Quantity of) const {
    if (unit.empty()) return 0.0;
    for (const Unit& known : unitsOf(of)) {
      if (known.name == unit) return known.to_si;
    }
    return std::nullopt;
  }

  std::string name, unit;
};

}  // namespace

PlainCsv::PlainCsv(std::filesystem::path file, Diagnostics* diagnostics)
    : file_(std::move(file)), diagnostics_(diagnostics), stream_(file_) {
  if (!stream_ || std::filesystem::is_directory(file_)) {
    throw InputError(fmt::format("{}: cannot be opened", file_.string()));
  }
  std::string header;
  double ignored = 0.0;
  while (nextLine()) {
    const bool is_comment = line_.front() == '#';
    csv::split(line_, &fields_);
    if (!is_comment && csv::parse(fields_[0], &ignored)) break;
    if (!is_comment || fields_.size() > 1) header = line_;
  }
  if (!stream_ && line_.empty()) throw InputError(fmt::format("{}: holds no row of numbers", file_.string()));
  holds_line_ = true;
  column_count_ = fields_.size();
  if (header.empty()) {
    assumeColumns();
  } else {
    readHeader(header);
  }
  guessUnits();
}

bool PlainCsv::nextLine() {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    line_ = std::string(csv::trimmed(line_));
    if (!line_.empty()) return true;
  }
  line_.clear();
  return false;
}

void PlainCsv::readHeader(std::string_view header) {
  if (header.front() == '#') header.remove_prefix(1);
  std::vector<std::string_view> names;
  csv::split(header, &names);
  column_count_ = names.size();
  time_column_ = -1;
  const auto triadOf = [this](Quantity quantity) -> Triad& {
    return quantity == Quantity::Rate    ? gyroscope_
           : quantity == Quantity::Force ? accelerometer_
                                         : magnetometer_;
  };
  for (size_t i = 0; i < names.size(); ++i) {
    const Column column(names[i]);
    const auto toSi = [&](Quantity quantity) {
      const std::optional<double> factor = column.toSi(quantity);
      if (factor) return *factor;
      std::string known;
      for (const Unit& unit : unitsOf(quantity)) known += fmt::format(" {}", unit.name);
      throw InputError(fmt::format("{}: unit '{}' of column '{}' is not known; known for it are{}",
                                   file_.string(), column.unit, names[i], known));
    };
    if (column.isTime() && time_column_ < 0) {
      time_column_ = static_cast<int>(i);
      time_to_s_ = toSi(Quantity::Time);
      continue;
    }
    const std::optional<Quantity> quantity = column.quantity();
    if (!quantity || column.axis() < 0) continue;
    Triad& triad = triadOf(*quantity);
    if (triad.column[column.axis()] >= 0) continue;  // the first of a name counts
    triad.column[column.axis()] = static_cast<int>(i);
    triad.to_si = toSi(*quantity);
  }
  if (time_column_ < 0 || !(hasGyroscope() || hasAccelerometer() || hasMagnetometer())) {
    throw InputError(
        fmt::format("{}: header '{}' names no time and sensor; expected for example "
                    "`t [s], wx [rad/s], wy [rad/s], wz [rad/s], ax [m/s^2], ay …, mx [uT], …`",
                    file_.string(), header));
  }
}

void PlainCsv::assumeColumns() {
  const auto at = [](int first) { return Triad{{first, first + 1, first + 2}, 0.0}; };
  if (column_count_ == 4) {
    magnetometer_ = at(1);
  } else if (column_count_ == 7 || column_count_ == 10) {
    gyroscope_ = at(1);
    accelerometer_ = at(4);
    if (column_count_ == 10) magnetometer_ = at(7);
  } else {
    throw InputError(
        fmt::format("{}: {} columns without a header; expected a time and 3, 6 or 9 numbers, or a "
                    "header that names the columns",
                    file_.string(), column_count_));
  }
}

void PlainCsv::guessUnits() {
  if (gyroscope_.to_si == 0.0) gyroscope_.to_si = 1.0;
  const auto guess = [&](Triad* triad, const auto& guesses, const char* what) {
    if (!triad->isThere() || triad->to_si != 0.0) return;
    triad->to_si = 1.0;
    bool is_good = false;
    const double norm = valueOf(*triad, &is_good).norm();
    if (!is_good) return;
    for (const Guess& g : guesses) {
      if (norm < g.least || norm > g.most) continue;
      triad->to_si = g.unit.to_si;
      if (g.unit.to_si == 1.0) return;
      diagnostics_->report(Severity::Warning, std::string(what) + "_unit",
                           fmt::format("{}: no unit stated for the {}; its size, {:.4g}, says {}",
                                       file_.string(), what, norm, g.unit.name));
      return;
    }
    diagnostics_->report(
        Severity::Serious, std::string(what) + "_unit",
        fmt::format("{}: no unit stated for the {}, and its size, {:.4g}, fits none; taken for SI",
                    file_.string(), what, norm));
  };
  guess(&accelerometer_, kForceGuesses, "accelerometer");
  guess(&magnetometer_, kFieldGuesses, "magnetometer");
}

Vec3 PlainCsv::valueOf(const Triad& triad, bool* is_good) const {
  Vec3 value = Vec3::Zero();
  *is_good = true;
  for (int axis = 0; axis < 3; ++axis) {
    const auto column = static_cast<size_t>(triad.column[axis]);
    *is_good = *is_good && column < fields_.size() && csv::parse(fields_[column], &value[axis]);
  }
  *is_good = *is_good && value.allFinite();
  return triad.to_si * value;
}

std::string PlainCsv::parseFields(PlainReading* reading) const {
  if (fields_.size() != column_count_)
    return fmt::format("{} columns where {} are due", fields_.size(), column_count_);
  const std::string_view stamp = fields_[static_cast<size_t>(time_column_)];
  int64_t whole = 0;
  double seconds = 0.0;
  if (csv::parse(stamp, &whole) && (time_to_s_ == 0.0 || time_to_s_ < 0.5)) {
    // Whole numbers stay whole: a double would lose part of a microsecond at today's times.
    reading->time = Time::fromNanoseconds(whole * (time_to_s_ == 0.0 ? 1 : std::llround(time_to_s_ * 1e9)));
  } else if (csv::parse(stamp, &seconds) && std::isfinite(seconds) && std::abs(seconds) < 1e18) {
    reading->time = Time::fromSeconds(seconds * (time_to_s_ == 0.0 ? 1.0 : time_to_s_));
  } else {
    return fmt::format("'{}' is no time", stamp);
  }
  const auto read = [&](const Triad& triad, std::optional<Vec3>* into) {
    into->reset();
    if (!triad.isThere()) return true;
    bool is_good = false;
    *into = valueOf(triad, &is_good);
    return is_good;
  };
  const bool has_inertial =
      read(gyroscope_, &reading->angular_velocity) && read(accelerometer_, &reading->specific_force);
  const bool has_field = read(magnetometer_, &reading->field);
  if (!has_field) reading->field.reset();
  // A magnetometer slower than the rest, or one that fails, must not cost the row's other readings.
  const bool is_good = has_inertial && (has_field || gyroscope_.isThere() || accelerometer_.isThere());
  return is_good ? std::string() : "a column does not hold a finite number";
}

bool PlainCsv::next(PlainReading* reading) {
  while (holds_line_ || nextLine()) {
    holds_line_ = false;
    if (line_.front() == '#') continue;
    csv::split(line_, &fields_);
    // What ends with a comma ends with an empty cell where one more is due.
    if (fields_.size() + 1 == column_count_ && line_.back() == ',') fields_.emplace_back();
    const std::string problem = parseFields(reading);
    if (problem.empty() && magnetometer_.isThere() && !reading->field) {
      diagnostics_->report(
          Severity::Notice, "csv_field",
          fmt::format("{}:{}: no magnetometer reading in this row; its other readings are used",
                      file_.string(), line_number_));
    }
    if (problem.empty()) return true;
    diagnostics_->report(Severity::Warning, "csv_row",
                         fmt::format("{}:{}: {}; row passed over", file_.string(), line_number_, problem));
  }
  return false;
}

}  // namespace lodeline

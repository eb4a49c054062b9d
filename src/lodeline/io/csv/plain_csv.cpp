#include "lodeline/io/csv/plain_csv.h"

#include <fmt/core.h>

#include <cmath>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Number of rows from which the units and the time column are determined.
constexpr std::size_t kFirstRows = 100;
constexpr int64_t kMadeUpInterval_ns = 10'000'000;

constexpr char kExample[] = "`t [s], wx [rad/s], wy [rad/s], wz [rad/s], ax [m/s^2], ay …, mx [uT], …`";

bool namesSensors(const std::vector<ColumnName>& columns, const PlainCsvOptions& options) {
  const SensorColumns found = findSensorColumns(columns);
  const bool has_unnamed = (options.is_magnetometer || options.bare_columns) && found.unnamed;
  const bool has_triad = found.angular_rate || found.specific_force || found.field || has_unnamed;
  return has_triad && (!found.times.empty() || options.is_magnetometer);
}

}  // namespace

// The field is 20 to 70 uT; raw readings are up to a factor of two larger or smaller.
const std::array<PlainCsv::UnitGuess, 3> PlainCsv::kForceGuesses = {
    {{"m/s^2", 1.0, 4.9, 19.7},
     {"g", kStandardGravity, 0.5, 2.0},
     {"mg", 1e-3 * kStandardGravity, 500.0, 2000.0}}};
const std::array<PlainCsv::UnitGuess, 5> PlainCsv::kFieldGuesses = {{{"T", 1.0, 1e-5, 1.4e-4},
                                                                     {"uT", 1e-6, 10.0, 140.0},
                                                                     {"gauss", 1e-4, 0.1, 1.4},
                                                                     {"mgauss", 1e-7, 140.0, 1400.0},
                                                                     {"nT", 1e-9, 1e4, 1.4e5}}};

PlainCsv::PlainCsv(const std::filesystem::path& file, Diagnostics* diagnostics,
                   const PlainCsvOptions& options)
    : PlainCsv(openFile(file), file.string(), diagnostics, options) {}

PlainCsv::PlainCsv(std::unique_ptr<ByteSource> bytes, std::string name, Diagnostics* diagnostics,
                   const PlainCsvOptions& options)
    : name_(std::move(name)),
      options_(options),
      diagnostics_(diagnostics),
      table_(std::move(bytes), name_,
             {[options](const std::vector<ColumnName>& columns) { return namesSensors(columns, options); }},
             diagnostics) {
  if (table_.hasHeader()) {
    findColumns();
  } else if (!table_.unknownHeader().empty()) {
    throw InputError(fmt::format("{}: header '{}' names no time and sensor; expected for example {}", name_,
                                 excerpt(table_.unknownHeader()), kExample));
  }
  readFirstRows();
  if (first_.empty()) throw InputError(fmt::format("{}: holds no row of numbers", name_));
  if (!table_.hasHeader()) assumeColumns();
  settleTime();
  settleUnits();
}

void PlainCsv::findColumns() {
  const SensorColumns found = findSensorColumns(table_.columns());
  times_ = found.times;
  instance_column_ = found.instance;
  const auto take = [](const std::optional<TriadColumns>& columns, std::optional<Triad>* triad) {
    if (columns) *triad = Triad{*columns, 1.0};
  };
  take(found.angular_rate, &gyroscope_);
  take(found.specific_force, &accelerometer_);
  take(found.field, &magnetometer_);
  if (found.unnamed) takeBareColumns(*found.unnamed);
  for (const std::string& unused : found.unused) {
    diagnostics_->report(
        Severity::Notice, "csv_columns",
        fmt::format("{}: the columns {} are not used; others before them name the same sensor", name_,
                    unused));
  }
  requireKnownUnits(Quantity::AngularRate, gyroscope_);
  requireKnownUnits(Quantity::SpecificForce, accelerometer_);
  requireKnownUnits(Quantity::MagneticField, magnetometer_);
  if (!magnetometer_ || magnetometer_->unit.factor) return;
  magnetometer_->unit.factor = options_.field_unit_T;
  has_relative_field_ = found.has_relative_field && !options_.field_unit_T;
  if (!has_relative_field_) return;
  diagnostics_->report(
      Severity::Warning, "magnetometer_relative",
      name_ + ": the field of Xsens has no unit; 1 is the field where the maker calibrated it");
}

void PlainCsv::takeBareColumns(const TriadColumns& columns) {
  if (!options_.is_magnetometer && !options_.bare_columns) return;
  const Quantity quantity = options_.bare_columns.value_or(Quantity::MagneticField);
  std::optional<Triad>& triad = quantity == Quantity::AngularRate     ? gyroscope_
                                : quantity == Quantity::SpecificForce ? accelerometer_
                                                                      : magnetometer_;
  if (triad) return;
  triad = Triad{columns, 1.0};
  triad->unit = statedUnit(table_.columns()[columns.column[0]], quantity);
  if (options_.bare_columns) return;
  diagnostics_->report(
      Severity::Notice, "csv_columns",
      fmt::format("{}: the columns {} name no sensor; taken for the magnetometer", name_, columns.name));
}

void PlainCsv::requireKnownUnits(Quantity quantity, const std::optional<Triad>& triad) const {
  if (!triad || !triad->unit.isUnknown()) return;
  throw InputError(fmt::format("{}: unit '{}' of the columns {} is not known; known for the {} are {}", name_,
                               triad->unit.text, triad->name, toString(quantity), knownUnits(quantity)));
}

void PlainCsv::assumeColumns() {
  const auto at = [](std::size_t first) {
    return Triad{{{first, first + 1, first + 2}, {}, "without a header"}, 1.0};
  };
  const std::size_t count = table_.columnCount();
  if (count == 9 && (table_.label() == "Raw" || table_.label() == "Uni")) {
    // Accelerometer and gyroscope precede it, but they are not usable without times.
    magnetometer_ = at(6);
    diagnostics_->report(
        Severity::Notice, "csv_columns",
        fmt::format("{}: rows of 9 numbers after '{}:'; the last three are taken for the magnetometer", name_,
                    table_.label()));
    return;
  }
  times_.push_back({0, "column 1", {}, 1, {}, {}, 0});
  if (count == 3 && options_.is_magnetometer) {
    times_.clear();
    magnetometer_ = at(0);
  } else if (count == 4) {
    magnetometer_ = at(1);
  } else if (count == 7 || count == 10) {
    gyroscope_ = at(1);
    accelerometer_ = at(4);
    if (count == 10) magnetometer_ = at(7);
  } else {
    throw InputError(
        fmt::format("{}: {} columns without a header; expected a time and 3, 6 or 9 numbers, or a "
                    "header that names the columns, for example {}",
                    name_, count, kExample));
  }
}

void PlainCsv::readFirstRows() {
  while (first_.size() < kFirstRows && nextRow()) first_.push_back(std::move(row_));
}

bool PlainCsv::nextRow() {
  while (table_.next()) {
    row_.cells.clear();
    for (std::size_t i = 0; i < table_.columnCount(); ++i) row_.cells.emplace_back(table_.cell(i));
    row_.line = table_.line();
    if (!instance_column_) return true;
    const std::string& instance = row_.cells[*instance_column_];
    if (instance_.empty()) instance_ = instance;
    if (instance == instance_) return true;
    diagnostics_->report(
        Severity::Warning, "csv_instance",
        fmt::format("{}:{}: a row of sensor {} in a table that begins with sensor {}; only rows of "
                    "the latter are used",
                    name_, row_.line, excerpt(instance), excerpt(instance_)));
  }
  return false;
}

/// Selects the first time column with the maximum number of distinct values; a date or a constant is not a
/// time.
void PlainCsv::settleTime() {
  std::size_t most = 0;
  for (const TimeColumn& candidate : times_) {
    std::set<Time> values;
    TimeColumn parsed = candidate;
    parsed.unit = candidate.unit.value_or(TimeUnit::Nanoseconds);
    for (const Row& row : first_) {
      if (const std::optional<Time> time = timeOf(parsed, row)) values.insert(*time);
    }
    if (values.size() <= most) continue;
    most = values.size();
    time_ = candidate;
  }
  if (!time_) {
    if (times_.empty() || options_.is_magnetometer) return;
    throw InputError(
        fmt::format("{}: the column of times '{}' holds no numbers; expected seconds, or a header with "
                    "the unit such as `t [ms]`",
                    name_, times_.front().name));
  }
  if (!time_->unknown_unit.empty()) {
    throw InputError(fmt::format("{}: unit '{}' of the column '{}' is no unit of time; known are {}", name_,
                                 time_->unknown_unit, time_->name, knownStampUnits()));
  }
  settleTimeUnit();
}

/// Sets the stated time unit or, without one, the usual unit, unless only another unit gives a plausible
/// sensor rate.
void PlainCsv::settleTimeUnit() {
  std::vector<double> stamps;
  bool has_decimals = false;
  for (const Row& row : first_) {
    const std::string& cell = row.cells[time_->column];
    const std::optional<double> stamp = numberFrom(cell);
    if (!stamp) continue;
    stamps.push_back(*stamp * static_cast<double>(time_->units_per_count));
    has_decimals = has_decimals || cell.find_first_of(".,eE") != std::string::npos;
  }
  const TimeUnit usual = time_->unit.value_or(has_decimals ? TimeUnit::Seconds : TimeUnit::Nanoseconds);
  const bool is_stated = time_->unit.has_value();
  time_->unit = usual;
  const PlausibleRate rate = gyroscope_ || accelerometer_ ? kInertialRate : kMagnetometerRate;
  const bool are_ticks = usual == TimeUnit::Nanoseconds && areTicks(stamps, rate);
  const std::optional<TimeUnit> by_rate =
      are_ticks ? std::optional(TimeUnit::Ticks) : timeUnitOfStamps(stamps, rate);
  const double usual_hz = stampsPerUnit(stamps) / secondsPer(usual);
  // Low rates are accepted where the unit is stated.
  const double least_hz = is_stated ? 1e-3 : 0.8 * rate.least_hz;
  if (!is_stated && !are_ticks && usual == TimeUnit::Nanoseconds) refuseUnclearUnit(stamps, rate);
  const bool is_usual = !are_ticks && usual_hz > least_hz && usual_hz < 1.25 * rate.most_hz;
  if (!by_rate || time_->second || is_usual) return;
  time_->unit = by_rate;
  diagnostics_->report(
      Severity::Warning, "time_unit",
      fmt::format("{}: {} for the times in '{}' would mean {:.3g} readings a second; they are taken for {} "
                  "({:.4g} Hz); "
                  "write `t [{}]` into the header if so",
                  name_, is_stated ? nameOf(usual) : "the usual unit", time_->name, usual_hz,
                  nameOf(*by_rate), stampsPerUnit(stamps) / secondsPer(*by_rate), toString(*by_rate)));
}

/// Throws for counts of an unknown unit that as nanoseconds are of an unusually fast sensor, and as another
/// unit of a usual one.
void PlainCsv::refuseUnclearUnit(const std::vector<double>& stamps, PlausibleRate rate) const {
  constexpr double kUnusual = 0.4, kLeastUnixTime_ns = 1e18;
  const auto rateIn_hz = [&](TimeUnit unit) { return stampsPerUnit(stamps) / secondsPer(unit); };
  const double hz = rateIn_hz(TimeUnit::Nanoseconds);
  if (hz < kUnusual * rate.most_hz || hz > 1.25 * rate.most_hz || stamps.front() > kLeastUnixTime_ns) return;
  throw InputError(fmt::format(
      "{}: the times in '{}' are whole numbers without a unit: as nanoseconds they mean {:.4g} readings a "
      "second, as steps of 100 ns {:.4g}, as microseconds {:.4g}; state the unit in the header, as in `t "
      "[us]` or `t [100 ns]`",
      name_, time_->name, hz, rateIn_hz(TimeUnit::Ticks), rateIn_hz(TimeUnit::Microseconds)));
}

void PlainCsv::settleUnits() {
  if (gyroscope_) gyroscope_->to_si = gyroscope_->unit.factor.value_or(1.0);
  if (accelerometer_) guessUnit(kForceGuesses, "accelerometer", &*accelerometer_);
  if (!magnetometer_) return;
  // A calibration determines the unit from all readings.
  if (options_.is_magnetometer && !magnetometer_->unit.factor) return;
  guessUnit(kFieldGuesses, "magnetometer", &*magnetometer_);
}

void PlainCsv::guessUnit(std::span<const UnitGuess> guesses, const char* what, Triad* triad) {
  triad->to_si = triad->unit.factor.value_or(1.0);
  std::vector<double> norms;
  for (const Row& row : first_) {
    if (const std::optional<Vec3> value = valueOf(*triad, row)) norms.push_back(value->norm());
  }
  if (triad->unit.factor || norms.empty()) return;
  const double norm = median(std::move(norms));
  for (const UnitGuess& guess : guesses) {
    if (norm < guess.least || norm > guess.most) continue;
    triad->to_si = guess.to_si;
    if (guess.to_si == 1.0) return;
    diagnostics_->report(Severity::Warning, std::string(what) + "_unit",
                         fmt::format("{}: no unit stated for the {}; its size, {:.4g}, says {}", name_, what,
                                     norm, guess.name));
    return;
  }
  diagnostics_->report(
      Severity::Serious, std::string(what) + "_unit",
      fmt::format("{}: no unit stated for the {}, and its size, {:.4g}, fits none; taken for SI", name_, what,
                  norm));
}

std::optional<Vec3> PlainCsv::valueOf(const Triad& triad, const Row& row) const {
  Vec3 value;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> number = numberFrom(row.cells[triad.column[static_cast<std::size_t>(axis)]]);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    value[axis] = *number;
  }
  return triad.to_si * value;
}

std::optional<Time> PlainCsv::timeOf(const TimeColumn& time, const Row& row) const {
  const std::string_view second =
      time.second ? std::string_view(row.cells[*time.second]) : std::string_view();
  const std::optional<int64_t> ns = timeFrom_ns(time, *time.unit, row.cells[time.column], second);
  return ns ? std::optional(Time::fromNanoseconds(*ns)) : std::nullopt;
}

/// The time of a counter of 32 bits, continued where it starts again.
Time PlainCsv::continued(Time time) {
  const bool is_counter = *time_->unit == TimeUnit::Microseconds || *time_->unit == TimeUnit::Milliseconds;
  if (!is_counter || time_->second) return time;
  const int64_t before = wrap_.restarts();
  const int64_t ns_per_count = nanosecondsPer(*time_->unit) * time_->units_per_count;
  const Time result = Time::fromNanoseconds(wrap_.continued_ns(time.nanoseconds(), ns_per_count));
  if (wrap_.restarts() > before) {
    diagnostics_->report(
        Severity::Notice, "csv_counter_restart",
        fmt::format("{}:{}: the times in '{}' start again at zero, as those of a counter of 32 "
                    "bits do; counted on",
                    name_, row_.line, time_->name));
  }
  return result;
}

std::string PlainCsv::parseRow(PlainReading* reading) {
  reading->time = Time::fromNanoseconds(kMadeUpInterval_ns * row_count_);
  if (time_) {
    const std::optional<Time> time = timeOf(*time_, row_);
    if (!time) return fmt::format("'{}' is no time", excerpt(row_.cells[time_->column]));
    reading->time = continued(*time);
  }
  const auto read = [this](const std::optional<Triad>& triad, std::optional<Vec3>* into) {
    *into = triad ? valueOf(*triad, row_) : std::nullopt;
    return !triad || into->has_value();
  };
  const bool has_rate = read(gyroscope_, &reading->angular_velocity);
  const bool has_force = read(accelerometer_, &reading->specific_force);
  const bool has_field = read(magnetometer_, &reading->field);
  // A magnetometer that is slower or fails must not invalidate the other readings of a row, nor the reverse.
  if (options_.is_magnetometer && has_field) return {};
  const bool is_good = has_rate && has_force && (has_field || gyroscope_ || accelerometer_);
  return is_good ? std::string() : "a column does not hold a finite number";
}

bool PlainCsv::next(PlainReading* reading) {
  while (true) {
    if (!first_.empty()) {
      row_ = std::move(first_.front());
      first_.pop_front();
    } else if (!nextRow()) {
      return false;
    }
    ++row_count_;
    const std::string problem = parseRow(reading);
    if (problem.empty() && magnetometer_ && !reading->field) {
      diagnostics_->report(
          Severity::Notice, "csv_field",
          fmt::format("{}:{}: no magnetometer reading in this row; its other readings are used", name_,
                      row_.line));
    }
    if (problem.empty()) return true;
    diagnostics_->report(Severity::Warning, "csv_row",
                         fmt::format("{}:{}: {}; row passed over", name_, row_.line, problem));
  }
}

}  // namespace lodeline

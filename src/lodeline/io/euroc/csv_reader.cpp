#include "lodeline/io/euroc/csv_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/io/csv/sensor_columns.h"
#include "lodeline/io/streams/stream_rate.h"
#include "lodeline/io/tables/calendar_time.h"
#include "lodeline/io/tables/pose_columns.h"

namespace lodeline {
namespace {

std::size_t numberCount(CsvContent content) {
  switch (content) {
    case CsvContent::Images:
      return 0;
    case CsvContent::Imu:
      return 6;
    case CsvContent::Magnetometer:
      return 3;
    case CsvContent::Depth:
    case CsvContent::Altimeter:
      return 1;
    case CsvContent::Sonar:
      return 2;
    case CsvContent::TruePose:
      return 7;
  }
  return 0;
}

const char* expectedHeader(CsvContent content) {
  switch (content) {
    case CsvContent::Images:
      return "#timestamp [ns],filename";
    case CsvContent::Imu:
      return "#timestamp [ns],w_x [rad/s],w_y [rad/s],w_z [rad/s],a_x [m/s^2],a_y [m/s^2],a_z [m/s^2]";
    case CsvContent::Magnetometer:
      return "#timestamp [ns],m_x [T],m_y [T],m_z [T]";
    case CsvContent::Depth:
      return "#timestamp [ns],depth [m]";
    case CsvContent::Sonar:
      return "#timestamp [ns],range [m],angle [rad]";
    case CsvContent::Altimeter:
      return "#timestamp [ns],range [m]";
    case CsvContent::TruePose:
      return "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z";
  }
  return "";
}

std::unique_ptr<ByteSource> openSensorFile(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored) || std::filesystem::is_directory(file, ignored)) {
    throw InputError(fmt::format("{}: cannot be opened; the recording needs this file", file.string()));
  }
  return openFile(file);
}

bool namesTime(const ColumnName& column) {
  return column.hasWord({"t"}) || column.hasStem({"time", "stamp"});
}

/// Options that accept as header only a line with a time and at least the required columns; other lines are
/// prose.
TableOptions optionsFor(std::size_t number_count) {
  TableOptions options;
  options.is_header = [number_count](const std::vector<ColumnName>& columns) {
    return columns.size() > number_count && std::any_of(columns.begin(), columns.end(), namesTime);
  };
  // Image lists may or may not have the column of names, independent of the header.
  options.needs_rows = false;  // the caller decides whether rows are required
  options.least_columns = number_count == 0 ? 2 : 1 + number_count;
  options.optional_columns = number_count == 0 ? 1 : 0;
  return options;
}

std::optional<std::size_t> columnWith(const std::vector<ColumnName>& columns,
                                      std::initializer_list<std::string_view> words) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].hasWord(words)) return i;
  }
  return std::nullopt;
}

/// A number of a column that may be missing.
double numberOrNan(const std::optional<double>& number) {
  return number && std::isfinite(*number) ? *number : std::numeric_limits<double>::quiet_NaN();
}

bool hasDecimals(std::string_view stamp) { return stamp.find_first_of(".,") != std::string_view::npos; }

}  // namespace

double unitFactorOf(const std::filesystem::path& file, const StatedUnit& unit, Quantity quantity) {
  if (!unit.isUnknown()) return unit.factor.value_or(1.0);
  throw InputError(fmt::format("{}: unit '{}' of the {} is not known; known for it are {}", file.string(),
                               unit.text, toString(quantity), knownUnits(quantity)));
}

CsvReader::CsvReader(std::unique_ptr<ByteSource> bytes, std::filesystem::path file, std::size_t number_count,
                     Diagnostics* diagnostics)
    : file_(std::move(file)),
      table_(std::move(bytes), file_.string(), optionsFor(number_count), diagnostics) {
  for (std::size_t i = 0; i < number_count; ++i) numbers_.push_back({1 + i, 1.0});
  text_column_ = 1 + number_count;
}

CsvReader::CsvReader(const std::filesystem::path& file, int number_count, Diagnostics* diagnostics,
                     std::optional<PlausibleRate> rate)
    : CsvReader(openSensorFile(file), file, static_cast<std::size_t>(number_count), diagnostics) {
  if (!rate) return;
  Diagnostics reported_when_read_in_earnest;
  settleStampUnit(CsvReader(file, number_count, &reported_when_read_in_earnest), *rate, diagnostics);
}

CsvReader::CsvReader(const std::filesystem::path& file, CsvContent content, Diagnostics* diagnostics,
                     std::optional<PlausibleRate> rate)
    : CsvReader(openSensorFile(file), file, content, diagnostics) {
  if (!rate) return;
  Diagnostics reported_when_read_in_earnest;
  settleStampUnit(CsvReader(file, content, &reported_when_read_in_earnest), *rate, diagnostics);
}

CsvReader::CsvReader(const std::filesystem::path& file, const CsvLayout& layout, Diagnostics* diagnostics,
                     std::optional<PlausibleRate> rate)
    : CsvReader(openSensorFile(file), file, layout.least_columns, diagnostics) {
  if (!table_.hasHeader()) {
    throw InputError(fmt::format("{}: has no header that names its columns; expected one such as `{}`",
                                 file.string(), layout.expected_header));
  }
  CsvColumns found = layout.find(table_.columns());
  numbers_ = std::move(found.numbers);
  text_column_ = found.text.value_or(table_.columns().size());
  findTimeColumn(findSensorColumns(table_.columns()));
  if (!rate) return;
  Diagnostics reported_when_read_in_earnest;
  settleStampUnit(CsvReader(file, layout, &reported_when_read_in_earnest), *rate, diagnostics);
}

CsvReader::CsvReader(std::unique_ptr<ByteSource> bytes, const std::filesystem::path& file, CsvContent content,
                     Diagnostics* diagnostics)
    : CsvReader(std::move(bytes), file, numberCount(content), diagnostics) {
  if (table_.hasHeader()) findColumns(content);
}

void CsvReader::findColumns(CsvContent content) {
  const std::vector<ColumnName>& columns = table_.columns();
  const SensorColumns sensors = findSensorColumns(columns);
  const auto factorOf = [&](const StatedUnit& unit, Quantity quantity) {
    return unitFactorOf(file_, unit, quantity);
  };
  std::vector<CsvColumn> found;
  const auto addTriad = [&](const TriadColumns& triad, Quantity quantity) {
    for (const std::size_t column : triad.column) found.push_back({column, factorOf(triad.unit, quantity)});
  };
  const auto addLength = [&](std::optional<std::size_t> column) {
    if (column)
      found.push_back({*column, factorOf(statedUnit(columns[*column], Quantity::Length), Quantity::Length)});
  };
  switch (content) {
    case CsvContent::Images:
      if (const auto name = columnWith(columns, {"filename", "file", "name", "image", "path"}))
        text_column_ = *name;
      break;
    case CsvContent::Imu:
      if (sensors.angular_rate) addTriad(*sensors.angular_rate, Quantity::AngularRate);
      if (sensors.specific_force) addTriad(*sensors.specific_force, Quantity::SpecificForce);
      break;
    case CsvContent::Magnetometer:
      if (sensors.field) {
        addTriad(*sensors.field, Quantity::MagneticField);
      } else if (sensors.unnamed) {
        addTriad(*sensors.unnamed, Quantity::MagneticField);
      }
      break;
    case CsvContent::Depth:
      addLength(columnWith(columns, {"depth"}));
      if (found.empty() && std::any_of(columns.begin(), columns.end(),
                                       [](const ColumnName& column) { return column.hasStem({"press"}); })) {
        throw InputError(file_.string() +
                         ": its header names a pressure; expected a depth in metres, positive down");
      }
      break;
    case CsvContent::Sonar: {
      addLength(columnWith(columns, {"range", "distance"}));
      const auto angle = columnWith(columns, {"angle", "bearing", "azimuth"});
      const bool is_degrees = angle && columns[*angle].unit.find_first_of("dD") != std::string::npos &&
                              columns[*angle].unit.find("rad") == std::string::npos;
      if (angle) found.push_back({*angle, is_degrees ? M_PI / 180.0 : 1.0});
      break;
    }
    case CsvContent::Altimeter:
      addLength(columnWith(columns, {"range", "distance", "altitude", "height"}));
      break;
    case CsvContent::TruePose:
      if (const std::optional<PoseColumns> pose = findPoseColumns(columns)) {
        for (const std::size_t column : pose->position) found.push_back({column, pose->position_to_m});
        for (const std::size_t i : {3, 0, 1, 2}) found.push_back({pose->rotation[i], 1.0});
        text_column_ = 1 + numbers_.size();
      }
      break;
  }
  if (found.size() == numbers_.size()) {
    numbers_ = std::move(found);
  } else if (!found.empty()) {
    throw InputError(
        fmt::format("{}: its header names only part of what it should hold; expected columns such as `{}`",
                    file_.string(), expectedHeader(content)));
  }
  findTimeColumn(sensors);
}

void CsvReader::findTimeColumn(const SensorColumns& sensors) {
  if (sensors.times.empty()) return;
  const TimeColumn& time = sensors.times.front();
  if (!time.unknown_unit.empty()) {
    throw InputError(fmt::format("{}: unit '{}' of the column '{}' is no unit of time; known are {}",
                                 file_.string(), time.unknown_unit, time.name, knownStampUnits()));
  }
  time_column_ = time.column;
  if (time.second) two_columns_ = time;
  if (!time.unit || *time.unit == TimeUnit::Nanoseconds) return;
  stamp_unit_ = *time.unit;
  decimal_unit_ = time.unit;
}

void CsvReader::settleStampUnit(CsvReader ahead, PlausibleRate rate, Diagnostics* diagnostics) {
  if (stamp_unit_ != TimeUnit::Nanoseconds) return;  // the header states another
  std::vector<double> stamps;
  bool has_decimals = false;
  while (stamps.size() < kStampsForRate && ahead.table_.next()) {
    const std::optional<double> stamp = numberFrom(ahead.stampText());
    if (!stamp) continue;
    has_decimals = has_decimals || hasDecimals(ahead.stampText());
    stamps.push_back(*stamp);
  }
  if (has_decimals) {
    decimal_unit_ = timeUnitOfStamps(stamps, rate).value_or(TimeUnit::Seconds);
    return;
  }
  stamp_unit_ = unitOfNanosecondStamps(stamps, rate);
  if (stamp_unit_ == TimeUnit::Nanoseconds) return;
  diagnostics->report(
      Severity::Warning, "stamp_unit",
      fmt::format(
          "{}: the stamps count {}, not nanoseconds: as nanoseconds the readings would come at {:.3g} Hz, "
          "as {} they come at {:.4g} Hz. Read as such; state the unit in the header, `t [{}]`, to make it "
          "clear",
          file_.string(), nameOf(stamp_unit_), stampsPerUnit(stamps) * 1e9, nameOf(stamp_unit_),
          stampsPerUnit(stamps) / secondsPer(stamp_unit_), toString(stamp_unit_)));
}

std::string CsvReader::parseRow(CsvRow* row) const {
  const std::string_view stamp = stampText();
  const std::optional<TimeUnit> unit = hasDecimals(stamp) ? decimal_unit_ : std::optional(stamp_unit_);
  std::optional<int64_t> stamp_ns;
  if (two_columns_) {
    stamp_ns = timeFrom_ns(*two_columns_, stamp_unit_, stamp, table_.cell(*two_columns_->second));
  } else if (unit) {
    stamp_ns = table_.time_ns(time_column_, *unit);
  }
  if (!stamp_ns && !two_columns_) stamp_ns = parseCalendarTime_ns(stamp);
  if (!stamp_ns && unit && *unit != TimeUnit::Nanoseconds && numberFrom(stamp)) {
    return fmt::format(
        "the time stamp '{}' is no time in {}, the unit that the rate of the readings suggests",
        excerpt(stamp), nameOf(*unit));
  }
  if (!stamp_ns) {
    return fmt::format("the time stamp '{}' is not an integer number of nanoseconds", excerpt(stamp));
  }
  row->time = Time::fromNanoseconds(*stamp_ns);
  row->numbers.resize(numbers_.size());
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const std::optional<double> number = table_.number(numbers_[i].column);
    if (numbers_[i].may_be_missing) {
      row->numbers[i] = numbers_[i].to_si * numberOrNan(number);
      continue;
    }
    if (!number || !std::isfinite(*number)) {
      return fmt::format("'{}' in column {} is not a {}number", excerpt(table_.cell(numbers_[i].column)),
                         numbers_[i].column + 1, number ? "finite " : "");
    }
    row->numbers[i] = numbers_[i].to_si * *number;
  }
  row->text = text_column_ < table_.columnCount() ? std::string(table_.cell(text_column_)) : std::string();
  return {};
}

bool CsvReader::next(CsvRow* row) {
  while (table_.next()) {
    const std::string problem = parseRow(row);
    if (problem.empty()) return true;
    table_.passOver(problem);
  }
  return false;
}

std::optional<double> CsvReader::shareRead() const {
  std::error_code failure;
  const auto bytes = static_cast<double>(std::filesystem::file_size(file_, failure));
  const auto bytes_read = static_cast<double>(table_.bytesRead());
  if (failure || bytes_read > bytes) return std::nullopt;
  return bytes > 0.0 ? bytes_read / bytes : 1.0;
}

}  // namespace lodeline

#include "lodeline/evaluation/trajectory/pose_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/pose_columns.h"

namespace lodeline {
namespace {

/// Plausible rates: from one keyframe per ten seconds to the rate of an IMU.
constexpr PlausibleRate kPoseRate = {0.1, 2000.0};
constexpr double kTolerance = 0.05;

bool namesPose(const std::vector<ColumnName>& columns) {
  return findPoseColumns(columns).has_value() && !findTimeColumns(columns).empty();
}

TableOptions poseTableOptions() {
  TableOptions options;
  options.is_header = namesPose;
  options.finding = "truncated_line";
  options.refuses_misfits = true;
  return options;
}

/// Unit in which a number of this size is a Unix time between 1973 and 5138; seconds for a clock that starts
/// at zero, and ticks of 100 ns where these are a current time.
TimeUnit unitBySizeOf(double stamp) {
  if (isCurrentTimeInTicks(stamp)) return TimeUnit::Ticks;
  const double size = std::abs(stamp);
  return size >= 1e17   ? TimeUnit::Nanoseconds
         : size >= 1e14 ? TimeUnit::Microseconds
         : size >= 1e11 ? TimeUnit::Milliseconds
                        : TimeUnit::Seconds;
}

bool isRotation(const Mat3& matrix) {
  return (matrix * matrix.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff() < kTolerance &&
         matrix.determinant() > 0.0;
}

}  // namespace

PoseRows::PoseRows(std::unique_ptr<ByteSource> bytes, std::string name, bool ignores_header,
                   Diagnostics& diagnostics)
    : name_(std::move(name)) {
  TableReader table(std::move(bytes), name_, poseTableOptions(), &diagnostics);
  if (!ignores_header) columns_ = table.columns();
  preamble_ = table.preamble();
  column_count_ = table.columnCount();
  kept_columns_ = std::min(column_count_, kMostNumbers);
  has_separators_ = table.separator() != Separator::Blanks;
  times_ = {0};
  if (!columns_.empty()) {
    const TimeColumn time = findTimeColumns(columns_).front();
    times_ = {time.column};
    if (time.second) times_.push_back(*time.second);
    const PoseColumns pose = *findPoseColumns(columns_);
    for (const std::size_t column : pose.position) kept_columns_ = std::max(kept_columns_, column + 1);
    for (const std::size_t column : pose.rotation) kept_columns_ = std::max(kept_columns_, column + 1);
    kept_columns_ = std::max(kept_columns_, time.column + 1);
  }
  while (table.next()) keep(table);
  unknown_header_ = table.unknownHeader();
  if (!lines_.empty()) return;
  if (table.unknownHeader().empty()) throw InputError(fmt::format("{}: holds no data lines", name_));
  throw InputError(
      fmt::format("{}: '{}' is neither a row of a trajectory (a time in seconds or nanoseconds, then the "
                  "pose) nor a header that names time, position and quaternion, such as `timestamp [s], "
                  "x, y, z, qx, qy, qz, qw`",
                  name_, excerpt(table.unknownHeader())));
}

void PoseRows::keep(const TableReader& table) {
  for (std::size_t column = 0; column < kept_columns_; ++column) {
    const std::optional<double> number = table.number(column);
    numbers_.push_back(number.value_or(std::nan("")));
    if (!number && no_numbers_.size() < 10000) no_numbers_[{size(), column}] = excerpt(table.cell(column));
  }
  for (const std::size_t column : times_) time_texts_.emplace_back(table.cell(column));
  lines_.push_back(table.line());
}

std::string PoseRows::where(std::size_t row) const { return fmt::format("{}:{}", name_, lines_[row]); }

double PoseRows::number(std::size_t row, std::size_t column) const {
  const double number = value(row, column);
  if (!std::isnan(number)) return number;
  const auto text = no_numbers_.find({row, column});
  if (text == no_numbers_.end()) return number;
  throw InputError(
      fmt::format("{}: column {} is '{}', expected a number", where(row), column + 1, text->second));
}

Eigen::Matrix4d PoseRows::matrix(std::size_t row, std::size_t first_column) const {
  Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 12; ++i) result(i / 4, i % 4) = number(row, first_column + static_cast<std::size_t>(i));
  return result;
}

bool PoseRows::areMatrices(std::size_t first_column) const {
  const bool has_last_row = column_count_ >= first_column + 16;
  std::size_t good = 0, finite = 0;
  for (std::size_t row = 0; row < size(); ++row) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int i = 0; i < (has_last_row ? 16 : 12); ++i) {
      matrix(i / 4, i % 4) = value(row, first_column + static_cast<std::size_t>(i));
    }
    if (!matrix.allFinite()) continue;
    ++finite;
    const bool ends_well = matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), 1e-9);
    good += ends_well && isRotation(matrix.topLeftCorner<3, 3>()) ? 1 : 0;
  }
  return finite > 0 && 10 * good >= 9 * finite;
}

bool PoseRows::areQuaternions(std::size_t first_column) const {
  std::size_t good = 0, finite = 0;
  for (std::size_t row = 0; row < size(); ++row) {
    double norm = 0.0;
    for (std::size_t i = 0; i < 4; ++i) norm = std::hypot(norm, value(row, first_column + i));
    if (!std::isfinite(norm)) continue;
    ++finite;
    good += std::abs(norm - 1.0) < kTolerance ? 1 : 0;
  }
  return finite > 0 && 10 * good >= 9 * finite;
}

bool PoseRows::timesAreNanoseconds() const {
  if (unitBySizeOf(value(0, 0)) == TimeUnit::Nanoseconds) return true;
  return std::any_of(preamble_.begin(), preamble_.end(), [](const std::string& line) {
    return line.find("timestamp [ns]") != std::string::npos;  // of a clock that starts at zero
  });
}

bool PoseRows::timesHaveDecimals() const {
  return std::any_of(time_texts_.begin(), time_texts_.end(),
                     [](const std::string& text) { return text.find_first_of(".eE") != std::string::npos; });
}

TimeUnit PoseRows::timeUnit(const TimeColumn& column, Diagnostics& diagnostics) const {
  if (!column.unknown_unit.empty()) {
    throw InputError(fmt::format("{}: unit '{}' of the column '{}' is no unit of time; known are {}", name_,
                                 column.unknown_unit, column.name, knownStampUnits()));
  }
  std::vector<double> stamps;
  for (std::size_t row = 0; row < size(); ++row) stamps.push_back(value(row, column.column));
  std::erase_if(stamps, [](double stamp) { return !std::isfinite(stamp); });
  if (stamps.empty()) return column.unit.value_or(TimeUnit::Seconds);
  const TimeUnit by_size = timesAreNanoseconds() ? TimeUnit::Nanoseconds : unitBySizeOf(stamps.front());
  const TimeUnit usual = column.unit.value_or(by_size);
  const double rate_hz =
      static_cast<double>(column.units_per_count) * stampsPerUnit(stamps) / secondsPer(usual);
  if (rate_hz == 0.0 || column.second || (rate_hz > 1e-3 && rate_hz < 1e5)) {
    if (!column.unit && usual != TimeUnit::Nanoseconds && usual != TimeUnit::Seconds) {
      diagnostics.report(
          Severity::Notice, "time_unit",
          fmt::format("{}: no unit stated for the times; by their size they are {}", name_, nameOf(usual)));
    }
    return usual;
  }
  const std::optional<TimeUnit> by_rate = timeUnitOfStamps(stamps, kPoseRate);
  if (!by_rate || *by_rate == usual) return usual;
  diagnostics.report(Severity::Warning, "time_unit",
                     fmt::format("{}: in {} the poses come at {:.3g} Hz; the times are taken for {}", name_,
                                 nameOf(usual), rate_hz, nameOf(*by_rate)));
  return *by_rate;
}

std::string PoseRows::timeText(std::size_t row, std::size_t column) const {
  const auto at = std::find(times_.begin(), times_.end(), column);
  return at == times_.end()
             ? std::string()
             : time_texts_[row * times_.size() + static_cast<std::size_t>(at - times_.begin())];
}

Time PoseRows::time(std::size_t row, const TimeColumn& column, TimeUnit unit) const {
  const std::string text = timeText(row, column.column);
  const std::string second = column.second ? timeText(row, *column.second) : std::string();
  if (const std::optional<int64_t> ns = timeFrom_ns(column, unit, text, second))
    return Time::fromNanoseconds(*ns);
  throw InputError(fmt::format("{}: column {} is '{}', expected a time in {}", where(row), column.column + 1,
                               excerpt(text), nameOf(unit)));
}

}  // namespace lodeline

#include "lodeline/data/csv_reader.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"
#include "lodeline/streams/stream_rate.h"

namespace lodeline {
namespace {

using csv::parse;
using csv::split;
using csv::trimmed;

bool startsLikeNumber(std::string_view text) {
  return !text.empty() && (text.front() == '-' || text.front() == '+' || std::isdigit(text.front()) != 0);
}

bool hasDecimals(std::string_view stamp) { return stamp.find('.') != std::string_view::npos; }

}  // namespace

CsvReader::CsvReader(std::filesystem::path file, int number_count, Diagnostics* diagnostics,
                     std::optional<PlausibleRate> rate)
    : file_(std::move(file)),
      number_count_(static_cast<size_t>(number_count)),
      column_count_(1 + number_count_),
      diagnostics_(diagnostics),
      stream_(file_) {
  if (!stream_ || std::filesystem::is_directory(file_)) {
    throw InputError(fmt::format("{}: cannot be opened; the recording needs this file", file_.string()));
  }
  if (rate) settleStampUnit(*rate);
}

void CsvReader::settleStampUnit(PlausibleRate rate) {
  std::vector<double> stamps;
  bool has_decimals = false;
  while (stamps.size() < kStampsForRate && std::getline(stream_, line_)) {
    split(trimmed(line_), &fields_);
    double stamp = 0.0;
    if (!parse(fields_[0], &stamp)) continue;
    has_decimals = has_decimals || hasDecimals(fields_[0]);
    stamps.push_back(stamp);
  }
  stream_.clear();
  stream_.seekg(0);
  if (has_decimals) {
    decimal_unit_ = timeUnitOfStamps(stamps, rate).value_or(TimeUnit::Seconds);
    return;
  }
  stamp_unit_ = unitOfNanosecondStamps(stamps, rate);
  if (stamp_unit_ == TimeUnit::Nanoseconds) return;
  diagnostics_->report(
      Severity::Warning, "stamp_unit",
      fmt::format(
          "{}: the stamps count {}, not nanoseconds: as nanoseconds the readings would come at {:.3g} Hz, "
          "as {} they come at {:.4g} Hz. Read as such; multiply the column by {} to make it clear",
          file_.string(), nameOf(stamp_unit_), stampsPerUnit(stamps) * 1e9, nameOf(stamp_unit_),
          stampsPerUnit(stamps) / secondsPer(stamp_unit_), nanosecondsPer(stamp_unit_)));
}

bool CsvReader::next(CsvRow* row) {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    const std::string_view line = trimmed(line_);
    if (line.empty()) continue;
    if (line.front() == '#' || (line_number_ == 1 && !startsLikeNumber(line))) {
      readHeader(line);
      continue;
    }
    std::string problem = parseLine(line, row);
    if (problem.empty()) return true;
    if (stream_.eof()) problem += " (the file's last line, without a line end: it was cut off)";
    diagnostics_->report(Severity::Warning, "csv_row",
                         fmt::format("{}:{}: {}; row passed over", file_.string(), line_number_, problem));
  }
  return false;
}

void CsvReader::readHeader(std::string_view header) {
  split(header, &fields_);
  // Only a header that names at least what is needed says something about the columns; others are prose.
  if (fields_.size() > column_count_) column_count_ = fields_.size();
}

std::string CsvReader::parseLine(std::string_view line, CsvRow* row) {
  split(line, &fields_);
  // Lists without numbers may or may not have their text column, whatever the header says.
  if (number_count_ > 0 && fields_.size() != column_count_) {
    return fmt::format("{} columns where {} are due", fields_.size(), column_count_);
  }
  const std::optional<TimeUnit> unit = hasDecimals(fields_[0]) ? decimal_unit_ : std::optional(stamp_unit_);
  const std::optional<int64_t> stamp_ns = unit ? parseTime_ns(fields_[0], *unit) : std::nullopt;
  if (!stamp_ns) {
    return fmt::format("the time stamp '{}' is not an integer number of nanoseconds", fields_[0]);
  }
  row->time = Time::fromNanoseconds(*stamp_ns);
  row->numbers.resize(number_count_);
  for (size_t i = 0; i < number_count_; ++i) {
    if (!parse(fields_[1 + i], &row->numbers[i])) {
      return fmt::format("'{}' in column {} is not a number", fields_[1 + i], i + 2);
    }
    if (!std::isfinite(row->numbers[i])) {
      return fmt::format("'{}' in column {} is not a finite number", fields_[1 + i], i + 2);
    }
  }
  row->text = fields_.size() > 1 + number_count_ ? std::string(fields_[1 + number_count_]) : std::string();
  return {};
}

}  // namespace lodeline

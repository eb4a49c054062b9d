#include "lodeline/data/csv_reader.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"

namespace lodeline {
namespace {

using csv::parse;
using csv::split;
using csv::trimmed;

bool startsLikeNumber(std::string_view text) {
  return !text.empty() && (text.front() == '-' || text.front() == '+' || std::isdigit(text.front()) != 0);
}

}  // namespace

CsvReader::CsvReader(std::filesystem::path file, int number_count, Diagnostics* diagnostics)
    : file_(std::move(file)),
      number_count_(static_cast<size_t>(number_count)),
      column_count_(1 + number_count_),
      diagnostics_(diagnostics),
      stream_(file_) {
  if (!stream_ || std::filesystem::is_directory(file_)) {
    throw InputError(fmt::format("{}: cannot be opened; the recording needs this file", file_.string()));
  }
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
  int64_t stamp_ns = 0;
  if (!parse(fields_[0], &stamp_ns)) {
    return fmt::format("the time stamp '{}' is not an integer number of nanoseconds", fields_[0]);
  }
  row->time = Time::fromNanoseconds(stamp_ns);
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

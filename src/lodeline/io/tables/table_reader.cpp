#include "lodeline/io/tables/table_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Limits of the search for a header: number of lines, lines after the first row, and bytes.
constexpr std::size_t kLinesBeforeHeader = 1000;
constexpr std::size_t kRowsBeforeHeader = 50;
constexpr std::size_t kBytesBeforeHeader = 4 << 20;

/// The text of a comment without its mark; nothing where the line is not a comment.
std::optional<std::string_view> commentOf(std::string_view text) {
  for (const std::string_view mark : {"#", "%", "//"}) {
    if (!text.starts_with(mark)) continue;
    while (text.starts_with(mark)) text.remove_prefix(mark.size());
    return trimmed(text);
  }
  return std::nullopt;
}

bool hasDigit(std::string_view cell) {
  return std::any_of(cell.begin(), cell.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Whether the cells are values rather than names: the first non-empty one is a number or starts with a digit
/// (a date, mm:ss).
bool areValues(const std::vector<std::string_view>& cells) {
  for (const std::string_view cell : cells) {
    if (cell.empty()) continue;
    return numberFrom(cell).has_value() || std::isdigit(static_cast<unsigned char>(cell.front())) != 0;
  }
  return false;
}

/// Whether the cells can be names of columns: a header has letters, no numbers, and possibly empty cells.
bool areNames(const std::vector<std::string_view>& cells) {
  return std::any_of(cells.begin(), cells.end(), [](std::string_view cell) { return !cell.empty(); }) &&
         std::none_of(cells.begin(), cells.end(),
                      [](std::string_view cell) { return numberFrom(cell).has_value() && hasDigit(cell); });
}

void dropEmptyAtEnd(std::vector<std::string_view>* cells, std::size_t least) {
  while (cells->size() > least && cells->back().empty()) cells->pop_back();
}

/// "Raw" of `Raw:1,2,3`: one word and a colon before three numbers or more.
std::string_view labelOf(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos || colon == 0 || colon > 20) return {};
  const std::string_view label = text.substr(0, colon);
  const bool is_word =
      std::all_of(label.begin(), label.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  std::vector<std::string_view> cells;
  std::vector<std::string> unquoted;
  splitCells(trimmed(text.substr(colon + 1)), separatorOf(text), &cells, &unquoted);
  const bool are_numbers = std::all_of(cells.begin(), cells.end(),
                                       [](std::string_view cell) { return numberFrom(cell).has_value(); });
  return is_word && are_numbers && cells.size() >= 3 ? label : std::string_view();
}

std::string_view withoutBrackets(std::string_view text) {
  if (text.size() >= 2 && (text.front() == '[' || text.front() == '(')) {
    return trimmed(text.substr(1, text.size() - 2));
  }
  return text;
}

}  // namespace

TableReader::TableReader(std::unique_ptr<ByteSource> bytes, std::string name, TableOptions options,
                         Diagnostics* diagnostics)
    : lines_(std::move(bytes), name),
      name_(std::move(name)),
      options_(std::move(options)),
      diagnostics_(diagnostics) {
  readPreamble();
  settleSeparator();
}

std::string TableReader::where() const { return fmt::format("{}:{}", name_, line_number_); }

bool TableReader::takeLine(Line* line) {
  std::string_view text;
  if (!lines_.next(&text)) return false;
  line->text.assign(text);  // reuses its memory from row to row
  line->number = lines_.number();
  line->was_too_long = lines_.wasTooLong();
  line->is_cut_off = lines_.hadNoEnd();
  return true;
}

void TableReader::split(std::string_view text, Separator separator, std::vector<std::string_view>* cells) {
  splitCells(text, separator, cells, &unquoted_);
}

/// Finds the header, or the first row of a table without one. Lines of values before the header are rows
/// where they have as many cells (a rotated log); otherwise they belong to the preamble.
void TableReader::readPreamble() {
  std::size_t bytes = 0, rows = 0, lines = 0;
  for (Line line; rows <= kRowsBeforeHeader && lines < kLinesBeforeHeader && bytes < kBytesBeforeHeader;) {
    if (!takeLine(&line)) break;
    ++lines;
    bytes += line.text.size();
    const std::string_view text = trimmed(line.text);
    if (text.empty()) continue;
    const std::optional<std::string_view> comment = commentOf(text);
    if (readAsHeader(line, comment.value_or(text))) {
      if (options_.may_have_units_below) readUnitsBelow();
      break;
    }
    if (comment) {
      if (rows == 0) preamble_.push_back(line.text);
      continue;
    }
    if (rows == 0) label_ = labelOf(text);
    split(text, separatorOf(text), &cells_);
    const bool is_row = areValues(cells_) || !label_.empty();
    rows += is_row || rows > 0 ? 1 : 0;
    if (rows > 0) {
      pending_.push_back(std::move(line));
    } else {
      unknown_header_ = text;
      preamble_.push_back(std::move(line.text));
    }
  }
  if (!hasHeader()) return;
  label_.clear();
  // Lines before the header were read without knowledge of its columns.
  std::erase_if(pending_, [&](const Line& line) {
    if (line.number > header_line_) return false;
    split(trimmed(line.text), separatorOf(line.text), &cells_);
    const bool is_row = areValues(cells_) && cells_.size() == columns_.size();
    if (!is_row) preamble_.push_back(line.text);
    return !is_row;
  });
}

bool TableReader::readAsHeader(const Line& line, std::string_view text) {
  if (!options_.is_header || line.was_too_long) return false;
  // Names may contain blanks, and prose may contain commas; the separator suggested by the line is tried
  // first.
  std::vector<ColumnName> names;
  for (const Separator separator : {separatorOf(text), Separator::Blanks}) {
    if (!splitNames(text, separator, &names)) return false;
    if (!options_.is_header(names)) continue;
    columns_ = std::move(names);
    column_count_ = columns_.size();
    separator_ = separator;
    header_text_ = trimmed(line.text);
    header_line_ = line.number;
    header_is_comment_ = commentOf(trimmed(line.text)).has_value();
    return true;
  }
  return false;
}

bool TableReader::splitNames(std::string_view text, Separator separator, std::vector<ColumnName>* names) {
  split(text, separator, &cells_);
  dropEmptyAtEnd(&cells_, 1);
  names->clear();
  if (!areNames(cells_)) return false;
  std::vector<std::string> texts;
  for (const std::string_view cell : cells_) {
    const bool is_unit = cell.starts_with('[') || cell.starts_with('(');
    if (separator == Separator::Blanks && is_unit && !texts.empty()) {
      texts.back() += " " + std::string(cell);
    } else {
      texts.emplace_back(cell);
    }
  }
  for (const std::string& name : texts) names->emplace_back(name);
  return true;
}

void TableReader::readUnitsBelow() {
  Line line;
  while (takeLine(&line)) {
    if (trimmed(line.text).empty()) continue;
    const std::string_view text = commentOf(trimmed(line.text)).value_or(trimmed(line.text));
    split(text, separator_, &cells_);
    const bool are_units = cells_.size() == columns_.size() && areNames(cells_) && !areValues(cells_) &&
                           std::none_of(cells_.begin(), cells_.end(), [](std::string_view cell) {
                             return numberFrom(cell).has_value() || cell.size() > 12;
                           });
    if (!are_units) {
      pending_.push_back(std::move(line));
      return;
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].unit.empty()) columns_[i].unit = withoutBrackets(cells_[i]);
    }
    return;
  }
}

/// Determines the separator of the rows, which may differ from that of the header: COLMAP has commas in its
/// header and blanks in its rows.
void TableReader::settleSeparator() {
  column_count_ = hasHeader() ? column_count_ : options_.least_columns;
  for (const Line& line : pending_) {
    std::string_view text = trimmed(line.text);
    if (text.empty() || commentOf(text)) continue;
    if (!label_.empty()) text = trimmed(text.substr(label_.size() + 1));
    const Separator likely = separatorOf(text);
    if (!hasHeader()) {
      split(text, likely, &cells_);
      dropEmptyAtEnd(&cells_, column_count_);
      if (cells_.size() < column_count_) continue;
      separator_ = likely;
      column_count_ = cells_.size();
      return;
    }
    for (const Separator separator : {separator_, likely, Separator::Tab, Separator::Blanks}) {
      split(text, separator, &cells_);
      if (!fits()) continue;
      separator_ = separator;
      return;
    }
    split(text, likely, &cells_);
    if (header_is_comment_ && separator_ == Separator::Blanks && cells_.size() < column_count_) {
      takeHeaderAsProse();
      settleSeparator();
      return;
    }
    if (!header_is_comment_ || cells_.size() <= column_count_) continue;
    separator_ = likely;
    nameFurtherColumns(cells_.size());
    return;
  }
}

/// Treats a header as prose where it is a sentence: `# timestamp in seconds, then x y z and qx qy qz qw`.
void TableReader::takeHeaderAsProse() {
  preamble_.push_back(std::move(header_text_));
  header_text_.clear();
  header_is_comment_ = false;
  columns_.clear();
}

/// Adds unnamed columns, because a comment may name only the first columns.
void TableReader::nameFurtherColumns(std::size_t count) {
  diagnostics_->report(Severity::Notice, "csv_columns",
                       fmt::format("{}: the header in line {} names the first {} of {} columns", name_,
                                   header_line_, column_count_, count));
  columns_.resize(count);
  column_count_ = count;
}

bool TableReader::fits() {
  dropEmptyAtEnd(&cells_, column_count_);
  if (cells_.size() + options_.optional_columns < column_count_) return false;
  if (cells_.size() < column_count_) cells_.resize(column_count_);
  return cells_.size() == column_count_;
}

bool TableReader::next() {
  while (true) {
    if (!pending_.empty()) {
      line_ = std::move(pending_.front());
      pending_.pop_front();
    } else if (!takeLine(&line_)) {
      if (options_.needs_rows && fitting_rows_ == 0 && !first_misfit_.empty())
        throw InputError(first_misfit_);
      return false;
    }
    std::string_view text = trimmed(line_.text);
    line_number_ = line_.number;
    is_cut_off_ = line_.is_cut_off;
    if (text.empty() || commentOf(text) || (hasHeader() && text == header_text_)) continue;
    if (!label_.empty()) {
      if (!text.starts_with(label_ + ":")) {
        passOver("does not begin with '" + label_ + ":' as the first row");
        continue;
      }
      text = trimmed(text.substr(label_.size() + 1));
    }
    split(text, separator_, &cells_);
    if (hasHeader() && !areValues(cells_)) refuseOtherHeader();
    if (options_.rows_may_be_short && cells_.size() < column_count_) cells_.resize(column_count_);
    if (fits() && !line_.was_too_long) {
      ++fitting_rows_;
      return true;
    }
    reportMisfit();
  }
}

void TableReader::refuseOtherHeader() {
  const std::vector<std::string_view> cells = cells_;
  const std::vector<ColumnName> names(cells.begin(), cells.end());
  if (!areNames(cells) || !options_.is_header(names)) return;
  throw InputError(fmt::format("{}: a second header, '{}', after that in line {}; split the file there",
                               where(), excerpt(line_.text), header_line_));
}

void TableReader::reportMisfit() {
  if (line_.was_too_long) {
    passOver(fmt::format("the line is longer than {} bytes", TextLines::kLongestLine));
    return;
  }
  const std::string problem = fmt::format("{} columns where {} are due", cells_.size(), column_count_);
  if (first_misfit_.empty()) {
    const std::string why =
        hasHeader() ? fmt::format("; the header in line {} names {}", header_line_, column_count_) : "";
    const bool is_twice = separator_ == Separator::Comma && cells_.size() == 2 * column_count_;
    const char* advice = is_twice
                             ? "; if these are decimal commas, save the table with decimal points, or with "
                               "semicolons between the columns"
                             : "";
    first_misfit_ = fmt::format("{}: {}, and no row has so many{}{}", where(), problem, why, advice);
  }
  const bool is_cut_off = is_cut_off_ && cells_.size() < column_count_ && fitting_rows_ > 0;
  if (options_.refuses_misfits && !is_cut_off) throw InputError(fmt::format("{}: {}", where(), problem));
  passOver(problem);
}

void TableReader::passOver(const std::string& problem) {
  diagnostics_->report(
      Severity::Warning, options_.finding,
      fmt::format("{}: {}{}; row passed over", where(), problem,
                  is_cut_off_ ? " (the file's last line, without a line end: it was cut off)" : ""));
}

}  // namespace lodeline

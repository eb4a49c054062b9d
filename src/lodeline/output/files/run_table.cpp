#include "lodeline/output/files/run_table.h"

#include <fmt/format.h>

#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

constexpr std::string_view kStampName = "#timestamp [ns]";

/// Destination of one column's values; one of the two is set.
struct Column {
  std::vector<double>* numbers = nullptr;
  std::vector<std::string>* words = nullptr;
};

/// Columns with the names of the header and the types of the first row.
std::vector<Column> makeColumns(const std::vector<std::string>& names,
                                const std::vector<std::string_view>& first_row, RunTable* table) {
  std::vector<Column> columns(names.size());
  for (size_t i = 1; i < names.size(); ++i) {
    double ignored = 0.0;
    if (csv::parse(first_row[i], &ignored)) {
      columns[i].numbers = &table->numbers[names[i]];
    } else {
      columns[i].words = &table->words[names[i]];
    }
  }
  return columns;
}

/// Returns false, without adding anything, where a field does not have its column's type.
bool addRow(const std::vector<std::string_view>& fields, const std::vector<Column>& columns,
            RunTable* table) {
  int64_t stamp_ns = 0;
  if (!csv::parse(fields[0], &stamp_ns)) return false;
  std::vector<double> numbers(fields.size());
  for (size_t i = 1; i < fields.size(); ++i) {
    if (columns[i].numbers && !csv::parse(fields[i], &numbers[i])) return false;
  }
  table->stamp_ns.push_back(stamp_ns);
  for (size_t i = 1; i < fields.size(); ++i) {
    if (columns[i].numbers) columns[i].numbers->push_back(numbers[i]);
    if (columns[i].words) columns[i].words->emplace_back(fields[i]);
  }
  return true;
}

std::vector<std::string> readNames(const std::filesystem::path& file, std::istream& stream) {
  std::string header;
  if (!std::getline(stream, header) || header.rfind(kStampName, 0) != 0) {
    throw InputError(fmt::format("{}:1: no header that begins with `{}`; is it a file of `lodeline run`?",
                                 file.string(), kStampName));
  }
  std::vector<std::string_view> fields;
  csv::split(header, &fields);
  return {fields.begin(), fields.end()};
}

}  // namespace

RunTable readRunTable(const std::filesystem::path& file, Diagnostics* diagnostics) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw InputError(file.string() + ": cannot be read; give the output folder of `lodeline run`");
  }
  const std::vector<std::string> names = readNames(file, stream);
  RunTable table;
  std::vector<Column> columns;
  std::vector<std::string_view> fields;
  std::string line;
  for (int number = 2; std::getline(stream, line); ++number) {
    csv::split(line, &fields);
    const bool is_complete = fields.size() == names.size();
    if (is_complete && columns.empty()) columns = makeColumns(names, fields, &table);
    if (is_complete && addRow(fields, columns, &table)) continue;
    if (stream.peek() != std::char_traits<char>::eof()) {
      throw InputError(fmt::format("{}:{}: {} fields where the header names {}, or one that is no number",
                                   file.string(), number, fields.size(), names.size()));
    }
    diagnostics->report(Severity::Warning, "run_file_cut_off",
                        fmt::format("{}:{}: cut off; passed over", file.string(), number));
  }
  return table;
}

}  // namespace lodeline

#include "apps/lodeline/benchmark/benchmark_table.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace lodeline {
namespace {

std::string cell(std::optional<double> figure, const char* format) {
  return figure ? fmt::format(fmt::runtime(format), *figure) : "";
}

std::optional<double> publishedBy(const PublishedMethod& method, const BenchmarkRow& row) {
  const auto found = row.sequence->published_m.find(method.name);
  if (found == row.sequence->published_m.end()) return std::nullopt;
  return found->second;
}

/// The cells of a row, from our figures on.
std::vector<std::string> figureCells(const BenchmarkSet& set, const BenchmarkRow& row) {
  std::vector<std::string> cells(4);
  if (row.errors) {
    cells = {cell(row.errors->path_m, "{:.1f}"), cell(row.errors->completion_percent, "{:.1f}"),
             cell(row.errors->position_rmse_m, "{:.4f}"), cell(row.errors->map_position_rmse_m, "{:.4f}")};
  }
  for (const PublishedMethod& method : set.published)
    cells.push_back(cell(publishedBy(method, row), "{:.3f}"));
  return cells;
}

std::string csvQuoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + "\"";
}

}  // namespace

std::string benchmarkMarkdown(const BenchmarkSet& set, const std::vector<BenchmarkRow>& rows,
                              const std::vector<std::string>& absent) {
  std::string text = fmt::format(
      "# {}\n\n{}.\n\nRoot mean square of the position errors after {} alignment, m. `causal` is the "
      "trajectory "
      "while it is recorded, `loops` the one with closed loops.\n\n",
      set.title, set.about, toString(set.alignment));
  text += "| sequence | status | path [m] | truth covered [%] | causal [m] | loops [m] |";
  std::string line = "| --- | --- | --- | --- | --- | --- |";
  for (const PublishedMethod& method : set.published) {
    text += fmt::format(" {} [m] |", method.name);
    line += " --- |";
  }
  text += " reason |\n" + line + " --- |\n";
  for (const BenchmarkRow& row : rows) {
    text += fmt::format("| {} | {} | {} | {} |\n", row.sequence->name, row.status,
                        fmt::join(figureCells(set, row), " | "), markdownText(row.reason));
  }
  if (!absent.empty()) text += fmt::format("\nNot in the folder: {}.\n", fmt::join(absent, ", "));
  text +=
      set.published.empty() ? "\nPublished figures of single sequences: none.\n" : "\nPublished figures:\n\n";
  for (const PublishedMethod& method : set.published) {
    text += fmt::format("- {}: {}\n", method.name, method.source);
  }
  if (!set.remarks.empty()) text += "\nRemarks:\n\n";
  for (const std::string& remark : set.remarks) text += fmt::format("- {}\n", remark);
  return text;
}

std::string benchmarkCsv(const BenchmarkSet& set, const std::vector<BenchmarkRow>& rows) {
  std::string text =
      "sequence,status,path_m,truth_covered_percent,causal_position_rmse_m,loops_position_rmse_m";
  for (const PublishedMethod& method : set.published) text += fmt::format(",{}_m", method.name);
  text += ",reason\n";
  for (const BenchmarkRow& row : rows) {
    text += fmt::format("{},{},{},{}\n", row.sequence->name, row.status,
                        fmt::join(figureCells(set, row), ","), csvQuoted(row.reason));
  }
  return text;
}

}  // namespace lodeline

#include "apps/lodeline/batch/batch_summary.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr size_t kWorstRows = 100;

std::optional<BatchErrors> errorsFrom(const nlohmann::ordered_json& json) {
  if (!json.is_object() || !json.contains("evaluation")) return std::nullopt;
  const auto& figures = json["evaluation"];
  BatchErrors errors{figures.value("path_m", 0.0),
                     figures.value("position_rmse_m", 0.0),
                     figures.value("position_rmse_percent", 0.0),
                     figures.value("rotation_rmse_deg", 0.0),
                     figures.value("drift_percent", 0.0),
                     figures.value("completion_percent", 0.0),
                     {}};
  if (figures.contains("map_position_rmse_m")) errors.map_position_rmse_m = figures["map_position_rmse_m"];
  return errors;
}

std::optional<int> numberFrom(const nlohmann::ordered_json& json, const char* key) {
  if (!json.is_object() || !json.contains(key) || !json[key].is_number()) return std::nullopt;
  return json[key].get<int>();
}

BatchRow rowOf(const BatchItem& item, const BatchList& list, const BatchFolder& folder,
               const fs::path& against) {
  BatchRow row;
  row.item = &item;
  const ItemState state = folder.state(item, keyOfItem(item, list));
  const auto result = readItemFile(folder.result(item));
  const auto failure = readItemFile(folder.failure(item));
  row.status = state == ItemState::Done                  ? "done"
               : state == ItemState::Failed              ? "failed"
               : !result.is_null() || !failure.is_null() ? "outdated"
                                                         : "open";
  const bool shows_failure = state == ItemState::Failed || result.is_null();
  const auto& json = shows_failure ? failure : result;
  row.exit_code = numberFrom(json, "exit_code");
  row.frames = numberFrom(json, "frames");
  row.frames_with_pose = numberFrom(json, "frames_with_pose");
  row.errors = errorsFrom(json);
  if (!against.empty()) row.errors_before = errorsFrom(readItemFile(BatchFolder(against).result(item)));
  if (json.is_object() && json.contains("last_lines") && !json["last_lines"].empty()) {
    row.reason = json["last_lines"].back().get<std::string>();
  }
  return row;
}

/// Rank by which rows are sorted, worst first.
auto rankOf(const BatchRow& row) {
  const int group = row.status == "failed" ? 0 : row.errors ? 1 : row.status == "open" ? 3 : 2;
  return std::make_tuple(group, row.errors ? -row.errors->position_rmse_percent : 0.0);
}

std::string csvText(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return quoted + "\"";
}

std::string cell(std::optional<int> number) { return number ? std::to_string(*number) : ""; }

std::string errorCell(const std::optional<BatchErrors>& errors, double BatchErrors::*figure) {
  return errors ? fmt::format("{:.4f}", (*errors).*figure) : "";
}

/// The rows of each variant, in the order of their names.
std::map<std::string, std::vector<const BatchRow*>> byVariant(const std::vector<BatchRow>& rows) {
  std::map<std::string, std::vector<const BatchRow*>> variants;
  for (const BatchRow& row : rows) variants[row.item->variant].push_back(&row);
  return variants;
}

Statistics statisticsOf(const std::vector<const BatchRow*>& rows, double BatchErrors::*figure) {
  std::vector<double> values;
  for (const BatchRow* row : rows) {
    if (row->errors) values.push_back((*row->errors).*figure);
  }
  return computeStatistics(values);
}

std::string variantTable(const std::vector<BatchRow>& rows) {
  std::string text =
      "| variant | items | done | failed | evaluated | median position RMSE [m] | median [% of path] | lower "
      "quartile [%] | upper quartile [%] | median rotation RMSE [deg] | median completion [%] |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& [name, members] : byVariant(rows)) {
    const auto with = [&members = members](const char* status) {
      return std::count_if(members.begin(), members.end(),
                           [&](const BatchRow* row) { return row->status == status; });
    };
    const Statistics percent = statisticsOf(members, &BatchErrors::position_rmse_percent);
    text += fmt::format("| {} | {} | {} | {} | {} |", name, members.size(), with("done"), with("failed"),
                        percent.count);
    if (percent.count == 0) {
      text += " | | | | | |\n";
      continue;
    }
    text += fmt::format(" {:.4f} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.1f} |\n",
                        statisticsOf(members, &BatchErrors::position_rmse_m).median, percent.median,
                        percent.lower_quartile, percent.upper_quartile,
                        statisticsOf(members, &BatchErrors::rotation_rmse_deg).median,
                        statisticsOf(members, &BatchErrors::completion_percent).median);
  }
  return text;
}

/// Position errors of the items that both batches have evaluated.
std::string comparisonTableOf(const std::vector<BatchRow>& rows) {
  std::string text;
  for (const auto& [name, members] : byVariant(rows)) {
    std::vector<double> now_m, before_m;
    int better = 0;
    int worse = 0;
    for (const BatchRow* row : members) {
      if (!row->errors || !row->errors_before) continue;
      now_m.push_back(row->errors->position_rmse_m);
      before_m.push_back(row->errors_before->position_rmse_m);
      better += now_m.back() < before_m.back() ? 1 : 0;
      worse += now_m.back() > before_m.back() ? 1 : 0;
    }
    if (now_m.empty()) continue;
    text += fmt::format("| {} | {} | {:.4f} | {:.4f} | {} | {} |\n", name, now_m.size(),
                        computeStatistics(before_m).median, computeStatistics(now_m).median, better, worse);
  }
  if (text.empty()) return "";
  return "\n## Comparison with the other batch\n\n"
         "| variant | items in both | median before [m] | median now [m] | better | worse |\n"
         "| --- | --- | --- | --- | --- | --- |\n" +
         text;
}

}  // namespace

std::string markdownText(std::string text) {
  std::replace(text.begin(), text.end(), '|', '/');
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string writeBatchTables(const std::vector<BatchRow>& rows, const BatchFolder& folder) {
  createOutputFolder(folder.path());
  replaceFile(folder.path() / "table.csv", batchCsv(rows));
  std::string markdown = batchMarkdown(rows);
  replaceFile(folder.path() / "table.md", markdown);
  return markdown;
}

std::vector<BatchRow> batchRows(const BatchList& list, const BatchFolder& folder, const fs::path& against) {
  std::vector<BatchRow> rows;
  for (const BatchItem& item : list.items) rows.push_back(rowOf(item, list, folder, against));
  std::stable_sort(rows.begin(), rows.end(),
                   [](const BatchRow& a, const BatchRow& b) { return rankOf(a) < rankOf(b); });
  return rows;
}

std::string batchCsv(const std::vector<BatchRow>& rows) {
  std::string text =
      "name,recording,variant,seed,status,exit_code,frames,frames_with_pose,path_m,position_rmse_m,"
      "position_rmse_percent,rotation_rmse_deg,drift_percent,completion_percent,position_rmse_before_m,"
      "reason\n";
  for (const BatchRow& row : rows) {
    text += fmt::format("{},{},{},{},{},{},{},{}", row.item->name, row.item->recording, row.item->variant,
                        cell(row.item->seed), row.status, cell(row.exit_code), cell(row.frames),
                        cell(row.frames_with_pose));
    for (const auto figure :
         {&BatchErrors::path_m, &BatchErrors::position_rmse_m, &BatchErrors::position_rmse_percent,
          &BatchErrors::rotation_rmse_deg, &BatchErrors::drift_percent, &BatchErrors::completion_percent}) {
      text += fmt::format(",{}", errorCell(row.errors, figure));
    }
    text += fmt::format(",{},{}\n", errorCell(row.errors_before, &BatchErrors::position_rmse_m),
                        csvText(row.reason));
  }
  return text;
}

std::string batchMarkdown(const std::vector<BatchRow>& rows) {
  std::string text = "# Batch\n\n" + variantTable(rows) + comparisonTableOf(rows);
  text += fmt::format("\n## Worst first\n\n{} of {} items; `table.csv` has all of them.\n\n",
                      std::min(kWorstRows, rows.size()), rows.size());
  text +=
      "| item | status | exit code | position RMSE [m] | [% of path] | rotation RMSE [deg] | completion [%] "
      "| reason |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (size_t i = 0; i < std::min(kWorstRows, rows.size()); ++i) {
    const BatchRow& row = rows[i];
    text += fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.item->name, row.status,
                        cell(row.exit_code), errorCell(row.errors, &BatchErrors::position_rmse_m),
                        errorCell(row.errors, &BatchErrors::position_rmse_percent),
                        errorCell(row.errors, &BatchErrors::rotation_rmse_deg),
                        errorCell(row.errors, &BatchErrors::completion_percent), markdownText(row.reason));
  }
  return text;
}

}  // namespace lodeline

#include "lodeline/output/report/page/map_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/output/report/data/row_choice.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Accepted loops on a page; beyond that, a choice of them.
constexpr size_t kMostLoops = 2000;
/// Moments that a page names for each reason.
constexpr size_t kMostMoments = 5;

/// Splits a line at its commas. Fields in quotes may contain commas, and doubled quotes.
std::vector<std::string> splitQuoted(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && is_quoted && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += line[i++];
    } else if (line[i] == '"') {
      is_quoted = !is_quoted;
    } else if (line[i] == ',' && !is_quoted) {
      fields.emplace_back();
    } else if (line[i] != '\r') {
      fields.back() += line[i];
    }
  }
  return fields;
}

/// A table of texts by the names of its header.
class TextTable {
 public:
  TextTable(const fs::path& file, Diagnostics* diagnostics) : file_(file) {
    std::ifstream stream(file, std::ios::binary);
    std::string line;
    if (!stream || !std::getline(stream, line) || line.empty() || line.front() != '#')
      throw InputError(fmt::format("{}:1: no header; is it a file of `lodeline run`?", file.string()));
    const std::vector<std::string> names = splitQuoted(line.substr(1));
    for (size_t i = 0; i < names.size(); ++i) columns_[names[i]] = i;
    for (int number = 2; std::getline(stream, line); ++number) {
      rows_.push_back(splitQuoted(line));
      if (rows_.back().size() == names.size()) continue;
      if (stream.peek() != std::char_traits<char>::eof()) {
        throw InputError(fmt::format("{}:{}: {} fields where the header names {}", file.string(), number,
                                     rows_.back().size(), names.size()));
      }
      rows_.pop_back();
      diagnostics->report(Severity::Warning, "run_file_cut_off",
                          fmt::format("{}:{}: cut off; passed over", file.string(), number));
    }
  }

  size_t rows() const { return rows_.size(); }
  const std::string& text(size_t row, const std::string& name) const {
    const auto column = columns_.find(name);
    if (column == columns_.end())
      throw InputError(fmt::format("{}:1: there is no column '{}'", file_.string(), name));
    return rows_[row][column->second];
  }
  template <typename Number>
  Number number(size_t row, const std::string& name) const {
    Number value{};
    if (!csv::parse(text(row, name), &value)) {
      throw InputError(fmt::format("{}:{}: '{}' is no number", file_.string(), row + 2, text(row, name)));
    }
    return value;
  }

 private:
  fs::path file_;
  std::map<std::string, size_t> columns_;
  std::vector<std::vector<std::string>> rows_;
};

nlohmann::json secondsAt(int64_t stamp_ns, int64_t origin_ns) {
  return shortNumber(1e-9 * static_cast<double>(stamp_ns - origin_ns));
}

/// A reason with its numbers replaced, so that reasons of one kind are counted together.
std::string kindOf(const std::string& reason) {
  static const std::regex number("[0-9]+([.][0-9]+)?(e[-+]?[0-9]+)?");
  return std::regex_replace(reason, number, "…");
}

/// Candidates that ended alike.
struct Outcome {
  std::string status, kind;
  std::string reason;  ///< of the first one
  int count = 0;
  std::vector<int64_t> moments_ns;
};

/// All outcomes, the most frequent first.
std::vector<Outcome> outcomesOf(const TextTable& ledger) {
  std::map<std::pair<std::string, std::string>, Outcome> by_kind;
  for (size_t row = 0; row < ledger.rows(); ++row) {
    const std::string &status = ledger.text(row, "status"), &reason = ledger.text(row, "reason");
    const std::string kind = kindOf(reason);
    Outcome& outcome =
        by_kind.try_emplace({status, kind}, Outcome{status, kind, reason, 0, {}}).first->second;
    ++outcome.count;
    if (outcome.moments_ns.size() < kMostMoments)
      outcome.moments_ns.push_back(ledger.number<int64_t>(row, "new_time [ns]"));
  }
  std::vector<Outcome> outcomes;
  for (auto& [key, outcome] : by_kind) outcomes.push_back(std::move(outcome));
  std::stable_sort(outcomes.begin(), outcomes.end(),
                   [](const Outcome& a, const Outcome& b) { return a.count > b.count; });
  return outcomes;
}

nlohmann::ordered_json outcomesJson(const TextTable& ledger, int64_t origin_ns) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Outcome& outcome : outcomesOf(ledger)) {
    nlohmann::json moments = nlohmann::json::array();
    for (const int64_t moment_ns : outcome.moments_ns) moments.push_back(secondsAt(moment_ns, origin_ns));
    // A single one keeps its numbers.
    json.push_back({{"status", outcome.status},
                    {"reason", outcome.count > 1 ? outcome.kind : outcome.reason},
                    {"count", outcome.count},
                    {"t_s", moments}});
  }
  return json;
}

nlohmann::ordered_json loopJson(const TextTable& ledger, size_t row, int64_t origin_ns) {
  const bool is_within = ledger.text(row, "new_dive") == ledger.text(row, "old_dive");
  nlohmann::ordered_json json;
  json["new_t_s"] = secondsAt(ledger.number<int64_t>(row, "new_time [ns]"), origin_ns);
  json["old_t_s"] = nullptr;
  if (is_within) json["old_t_s"] = secondsAt(ledger.number<int64_t>(row, "old_time [ns]"), origin_ns);
  if (!is_within) json["old_dive"] = ledger.text(row, "old_dive");
  json["source"] = ledger.text(row, "source");
  json["inliers"] = ledger.number<int>(row, "inliers");
  return json;
}

nlohmann::ordered_json acceptedJson(const TextTable& ledger, int64_t origin_ns) {
  std::vector<size_t> accepted;
  for (size_t row = 0; row < ledger.rows(); ++row) {
    if (ledger.text(row, "status") == "accepted") accepted.push_back(row);
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const size_t i : chooseRows(accepted.size(), kMostLoops, {}).rows)
    json.push_back(loopJson(ledger, accepted[i], origin_ns));
  return json;
}

/// Positions of the keyframes in the map, null where the run ended before they were written.
nlohmann::ordered_json pathJson(const fs::path& file, int64_t origin_ns, Diagnostics* diagnostics) {
  std::error_code error;
  if (fs::file_size(file, error) == 0 || error) return nullptr;
  TrajectoryReadOptions options;
  options.format = TrajectoryFormat::Tum;
  std::vector<int64_t> stamp_ns;
  std::vector<double> position[3];
  for (const StampedPose& pose : readTrajectory(file, options, *diagnostics).poses) {
    stamp_ns.push_back(pose.time.nanoseconds());
    for (int k = 0; k < 3; ++k) position[k].push_back(pose.world_from_body.translation[k]);
  }
  const std::vector<size_t> rows = chooseRows(stamp_ns.size(), kMostRows, {}).rows;
  return {{"t_s", secondsSince(origin_ns, stamp_ns, rows)},
          {"x", shortNumbers(position[0], rows)},
          {"y", shortNumbers(position[1], rows)},
          {"z", shortNumbers(position[2], rows)}};
}

nlohmann::ordered_json controlJson(const fs::path& file, int64_t origin_ns, Diagnostics* diagnostics) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  if (!fs::exists(file)) return json;
  const TextTable table(file, diagnostics);
  for (size_t row = 0; row < table.rows(); ++row) {
    json.push_back({{"name", table.text(row, "name")},
                    {"kind", table.text(row, "kind")},
                    {"t_s", secondsAt(table.number<int64_t>(row, "time [ns]"), origin_ns)},
                    {"error_m",
                     {shortNumber(table.number<double>(row, "east [m]")),
                      shortNumber(table.number<double>(row, "north [m]")),
                      shortNumber(table.number<double>(row, "up [m]"))}},
                    {"chi_squared", shortNumber(table.number<double>(row, "chi_squared"))},
                    {"is_blunder", table.text(row, "blunder") == "yes"}});
  }
  return json;
}

}  // namespace

nlohmann::ordered_json runMapJson(const fs::path& run, int64_t origin_ns, Diagnostics* diagnostics) {
  std::error_code error;
  if (fs::file_size(run / "loops.csv", error) == 0 || error) return nullptr;
  const TextTable ledger(run / "loops.csv", diagnostics);
  nlohmann::ordered_json json;
  json["pairs"] = ledger.rows();
  json["outcomes"] = outcomesJson(ledger, origin_ns);
  json["loops"] = acceptedJson(ledger, origin_ns);
  // A dive that another one places is in another frame than its odometry.
  const auto& loops = json["loops"];
  const bool is_own_frame =
      std::none_of(loops.begin(), loops.end(), [](const auto& loop) { return loop["old_t_s"].is_null(); });
  json["path"] = nullptr;
  if (is_own_frame) json["path"] = pathJson(run / "keyframes_map.tum", origin_ns, diagnostics);
  json["control"] = controlJson(run / "control.csv", origin_ns, diagnostics);
  return json;
}

}  // namespace lodeline

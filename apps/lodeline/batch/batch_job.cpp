#include "apps/lodeline/batch/batch_job.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "apps/lodeline/batch/child_process.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/printable_text.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr size_t kKeptErrorLines = 10;

/// The last lines of a file, without control characters.
std::vector<std::string> lastLines(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  std::vector<std::string> lines;
  std::string line;
  for (const char letter : readFileBytes(file) + "\n") {
    if (letter != '\n' && letter != '\r') {
      line += letter;
    } else if (!line.empty()) {
      lines.push_back(printableText(line));
      line.clear();
    }
  }
  if (lines.size() > kKeptErrorLines) lines.erase(lines.begin(), lines.end() - kKeptErrorLines);
  return lines;
}

/// Position RMSE of the trajectory in which the run's loops are closed; nothing where it has no poses.
std::optional<double> mapPositionRmse_m(const fs::path& result, const Trajectory& reference,
                                        const EvaluationOptions& options) {
  Diagnostics ignored;
  try {
    const Trajectory closed = readTrajectory(result / "trajectory_map.tum", {}, ignored);
    return evaluate(closed, reference, options, ignored).absolute.position().rmse;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Compares a result with the ground truth, writes evaluation.json and returns its main figures.
OrderedJson evaluateResult(const fs::path& result, const std::string& name, const fs::path& truth,
                           const BatchList& list) {
  Diagnostics diagnostics;
  Trajectory estimate = readTrajectory(result, {}, diagnostics);
  estimate.name = name;
  EvaluationOptions options;
  options.alignment = list.alignment;
  if (list.tolerance_s) options.association.tolerance_s = *list.tolerance_s;
  const Trajectory reference = readTrajectory(truth, {}, diagnostics);
  const Evaluation evaluation = evaluate(estimate, reference, options, diagnostics);
  writeOutput(result / "evaluation.json", jsonText(evaluationJson(evaluation, diagnostics)) + "\n");
  const double position_m = evaluation.absolute.position().rmse;
  OrderedJson figures = {{"path_m", evaluation.reference_path_m},
                         {"position_rmse_m", position_m},
                         {"position_rmse_percent", evaluation.percentOfPath(position_m)},
                         {"rotation_rmse_deg", evaluation.absolute.rotation().rmse},
                         {"drift_percent", evaluation.percentOfPath(evaluation.drift_m)},
                         {"completion_percent", 100.0 * evaluation.completion.share}};
  const auto map_position_m = mapPositionRmse_m(result, reference, options);
  if (map_position_m) figures["map_position_rmse_m"] = *map_position_m;
  return figures;
}

/// Moves a log beside the results; it is missing where the child could not be started.
void keepLog(const fs::path& from, const fs::path& folder) {
  std::error_code ignored;
  fs::rename(from, folder / from.filename(), ignored);
}

}  // namespace

BatchJob::BatchJob(const BatchList& list, const BatchFolder& folder, const BatchItem& item, std::string key)
    : list_(&list), folder_(&folder), item_(&item), key_(std::move(key)), started_(Clock::now()) {}

std::unique_ptr<BatchJob> BatchJob::start(const BatchList& list, const BatchFolder& folder,
                                          const BatchItem& item, const std::string& key, double stale_after_s,
                                          const std::function<bool()>& is_needed) {
  std::unique_ptr<BatchJob> job(new BatchJob(list, folder, item, key));
  job->claim_ = ItemClaim::take(folder.lock(item.name), stale_after_s);
  if (!job->claim_) return nullptr;
  if (!is_needed()) return nullptr;  // another process has finished it meanwhile
  if (item.simulate.empty() || folder.isSimulated(item)) {
    job->startRun();
    return job;
  }
  job->recording_claim_ = ItemClaim::take(folder.lock("recording-" + item.simulated_name), stale_after_s);
  if (!job->recording_claim_) return nullptr;
  if (folder.isSimulated(item)) {
    job->recording_claim_.reset();
    job->startRun();
  } else {
    job->startSimulation();
  }
  return job;
}

fs::path BatchJob::ownWork(const std::string& name) const { return folder_->work(name) / processLabel(); }

void BatchJob::startSimulation() {
  const std::string name = "recording-" + item_->simulated_name;
  std::error_code ignored;
  fs::remove_all(folder_->work(name), ignored);
  const fs::path work = ownWork(name);
  createOutputFolder(work);
  std::vector<std::string> words = {"simulate"};
  words.insert(words.end(), item_->simulate.begin(), item_->simulate.end());
  words.insert(words.end(), {"-o", (work / "made").string(), "--quiet"});
  child_ = startChild({words, list_->folder, work / "stdout.txt", work / "stderr.txt"});
}

void BatchJob::startRun() {
  std::error_code ignored;
  fs::remove_all(folder_->work(item_->name), ignored);
  const fs::path work = ownWork(item_->name);
  createOutputFolder(work);
  const std::string data = item_->simulate.empty() ? item_->data : folder_->simulated(*item_).string();
  std::vector<std::string> words = {"run", data, "-o", (work / "made").string()};
  words.insert(words.end(), item_->arguments.begin(), item_->arguments.end());
  started_ = Clock::now();
  child_ = startChild({words, list_->folder, work / "stdout.txt", work / "stderr.txt"});
}

std::optional<ItemState> BatchJob::proceed() {
  const std::optional<int> exit_code = exitOfChild(child_);
  if (!exit_code) return std::nullopt;
  if (!recording_claim_) return finishRun(*exit_code);
  const fs::path work = ownWork("recording-" + item_->simulated_name);
  if (*exit_code != 0) return fail(*exit_code, "simulate", "");
  writeItemFile(work / "made", {{"key", keyOfSimulation(*item_)}, {"simulate", item_->simulate}});
  publishFolder(work / "made", folder_->simulated(*item_));
  std::error_code ignored;
  fs::remove_all(folder_->work("recording-" + item_->simulated_name), ignored);
  recording_claim_.reset();
  startRun();
  return std::nullopt;
}

OrderedJson BatchJob::description(int exit_code) const {
  OrderedJson json = {{"name", item_->name}, {"recording", item_->recording}, {"variant", item_->variant}};
  if (item_->seed) json["seed"] = *item_->seed;
  json["key"] = key_;
  json["program"] = fmt::format("lodeline {}", LODELINE_VERSION);
  json["arguments"] = item_->arguments;
  json["exit_code"] = exit_code;
  json["worker"] = processLabel();
  json["seconds"] = std::chrono::duration<double>(Clock::now() - started_).count();
  return json;
}

ItemState BatchJob::finishRun(int exit_code) {
  if (exit_code != 0) return fail(exit_code, "run", "");
  const fs::path work = ownWork(item_->name);
  OrderedJson json = description(exit_code);
  try {
    const auto summary = OrderedJson::parse(readFileBytes(work / "made" / "run.json"));
    for (const char* key : {"frames", "frames_with_pose"}) {
      if (summary.contains(key)) json[key] = summary[key];
    }
    const bool is_simulated = !item_->simulate.empty();
    if (!item_->truth.empty()) {
      json["evaluation"] = evaluateResult(work / "made", item_->name, list_->folder / item_->truth, *list_);
    } else if (is_simulated) {
      json["evaluation"] = evaluateResult(work / "made", item_->name, folder_->simulated(*item_), *list_);
    }
  } catch (const std::exception& error) {
    return fail(exit_code, "evaluate", error.what());
  }
  for (const char* log : {"stdout.txt", "stderr.txt"}) keepLog(work / log, work / "made");
  writeItemFile(work / "made", json);
  publishFolder(work / "made", folder_->result(*item_));
  std::error_code ignored;
  fs::remove_all(folder_->failure(*item_), ignored);
  discard();
  return ItemState::Done;
}

ItemState BatchJob::fail(int exit_code, const std::string& stage, const std::string& message) {
  const fs::path work = ownWork(stage == "simulate" ? "recording-" + item_->simulated_name : item_->name);
  OrderedJson json = description(exit_code);
  json["stage"] = stage;
  json["last_lines"] = message.empty() ? lastLines(work / "stderr.txt") : std::vector{printableText(message)};
  const fs::path made = ownWork(item_->name) / "made";
  createOutputFolder(made);
  for (const char* log : {"stdout.txt", "stderr.txt"}) keepLog(work / log, made);
  writeItemFile(made, json);
  publishFolder(made, folder_->failure(*item_));
  discard();
  return ItemState::Failed;
}

void BatchJob::renew() const {
  claim_->renew();
  if (recording_claim_) recording_claim_->renew();
}

void BatchJob::discard() const {
  std::error_code ignored;
  fs::remove_all(folder_->work(item_->name), ignored);
  if (recording_claim_) fs::remove_all(folder_->work("recording-" + item_->simulated_name), ignored);
}

}  // namespace lodeline

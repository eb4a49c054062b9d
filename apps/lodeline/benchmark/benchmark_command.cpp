#include "apps/lodeline/benchmark/benchmark_command.h"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_command.h"
#include "apps/lodeline/batch/batch_summary.h"
#include "apps/lodeline/batch/batch_worker.h"
#include "apps/lodeline/benchmark/benchmark_set.h"
#include "apps/lodeline/benchmark/benchmark_table.h"
#include "apps/lodeline/benchmark/prepared_sequence.h"
#include "lodeline/diagnostics.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

const char* const kBenchmarkFooter =
    R"(docs/how-to/public-benchmarks.md explains sets and results. Given again, the command makes only what is missing.
Examples:
  lodeline benchmark euroc datasets/euroc --jobs 4
  lodeline benchmark tumvi datasets/tumvi -o tumvi_left --set source.cameras=[0]
  lodeline benchmark tank datasets/tank --shard 1/8)";

struct BenchmarkArguments {
  std::string set, folder, output;
  std::vector<std::string> settings;
  BatchWork work;
};

/// The runs as a list for `lodeline batch`.
std::string listText(const BenchmarkSet& set, const std::vector<PreparedSequence>& sequences,
                     const std::vector<std::string>& settings) {
  YAML::Node root;
  root["args"].push_back("--no-report");
  YAML::Node variant;
  variant["name"] = "default";
  for (const std::string& setting : settings) variant["set"].push_back(setting);
  root["variants"].push_back(variant);
  root["align"] = toString(set.alignment);
  if (set.tolerance_s) root["tolerance_s"] = *set.tolerance_s;
  for (const PreparedSequence& prepared : sequences) {
    if (prepared.data.empty()) continue;
    YAML::Node node;
    node["name"] = prepared.sequence->name;
    node["data"] = prepared.data;
    if (!prepared.truth.empty()) node["truth"] = prepared.truth;
    for (const std::string& word : prepared.arguments) node["args"].push_back(word);
    root["recordings"].push_back(node);
  }
  if (!root["recordings"].IsDefined()) return "";
  YAML::Emitter text;
  text << root;
  return std::string(text.c_str()) + "\n";
}

std::vector<BenchmarkRow> rowsOf(const std::vector<PreparedSequence>& sequences,
                                 const std::vector<BatchRow>& runs) {
  std::map<std::string, const BatchRow*> run_of;
  for (const BatchRow& run : runs) run_of[run.item->recording] = &run;
  std::vector<BenchmarkRow> rows;
  for (const PreparedSequence& prepared : sequences) {
    BenchmarkRow row{prepared.sequence, "broken", std::nullopt, prepared.problem};
    const auto run = run_of.find(prepared.sequence->name);
    if (run != run_of.end()) {
      row.status = run->second->status;
      row.errors = run->second->errors;
      if (row.reason.empty()) row.reason = run->second->reason;
    }
    rows.push_back(row);
  }
  return rows;
}

void runBenchmark(BenchmarkArguments arguments) {
  const BenchmarkSet set = benchmarkSet(arguments.set);
  const SetFolder files(arguments.folder);
  if (arguments.output.empty()) arguments.output = "benchmark_" + arguments.set;
  const BatchFolder folder(arguments.output);
  std::vector<PreparedSequence> sequences;
  std::vector<std::string> absent;
  Progress progress("preparing", arguments.work.quiet);
  double looked_at = 0.0;
  for (const SetSequence& sequence : set.sequences) {
    progress.show(looked_at++ / static_cast<double>(set.sequences.size()), sequence.name);
    auto prepared = prepareSequence(set, sequence, files, folder.path() / "sequences" / sequence.name);
    if (prepared) sequences.push_back(std::move(*prepared));
    if (!prepared) absent.push_back(sequence.name);
  }
  progress.end();
  if (sequences.empty()) {
    throw InputError(fmt::format("{}: no sequence of {} is here; looked for {}", arguments.folder, set.title,
                                 fmt::join(absent, ", ")));
  }
  createOutputFolder(folder.path());
  const std::string text = listText(set, sequences, arguments.settings);
  std::vector<BatchRow> runs;
  BatchList list;  // the rows refer to it
  if (!text.empty()) {
    replaceFile(folder.path() / "list.yaml", text);
    list = readBatchList(folder.path() / "list.yaml");
    workOnBatch(list, folder, arguments.work);
    runs = batchRows(list, folder, {});
    writeBatchTables(runs, folder);
  }
  const std::vector<BenchmarkRow> rows = rowsOf(sequences, runs);
  const std::string markdown = benchmarkMarkdown(set, rows, absent);
  replaceFile(folder.path() / "benchmark.md", markdown);
  replaceFile(folder.path() / "benchmark.csv", benchmarkCsv(set, rows));
  if (!arguments.work.quiet) fmt::print("{}", markdown);
  const auto bad = std::count_if(rows.begin(), rows.end(), [](const BenchmarkRow& row) {
    return row.status != "open" && row.status != "outdated" && !row.isGood();
  });
  if (bad > 0) throw BatchError(fmt::format("{} of {}; benchmark.md says why", bad, rows.size()));
}

}  // namespace

void addBenchmarkCommand(CLI::App& program) {
  const auto arguments = std::make_shared<BenchmarkArguments>();
  CLI::App* command = program.add_subcommand(
      "benchmark", "Run a public set of recordings and compare the errors with published ones");
  command->add_option("SET", arguments->set, "euroc, tumvi, uzhfpv, hilti22, tank or aqualoc")->required();
  command
      ->add_option("FOLDER", arguments->folder, "folder of the unpacked sequences, at most four levels down")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the results (default: benchmark_SET)");
  command->add_option("-s,--set", arguments->settings, "one setting of all runs");
  addBatchWorkOptions(&arguments->work, command);
  command->footer(kBenchmarkFooter);
  command->callback([arguments] { runBenchmark(*arguments); });
}

}  // namespace lodeline

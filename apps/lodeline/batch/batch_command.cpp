#include "apps/lodeline/batch/batch_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_list.h"
#include "apps/lodeline/batch/batch_summary.h"
#include "apps/lodeline/batch/batch_worker.h"
#include "apps/lodeline/batch/item_claim.h"
#include "lodeline/diagnostics.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

const char* const kBatchFooter =
    R"(docs/how-to/process-many-dives.md explains list and results.
Examples:
  lodeline batch LIST.yaml -o season --jobs 4
  lodeline batch LIST.yaml -o season --shard 3/100
  lodeline batch LIST.yaml -o season --retry
  lodeline batch LIST.yaml -o season --summary --against last_season)";

struct BatchArguments {
  std::string list;
  std::string output;
  std::string against;
  bool only_summary = false;
  BatchWork work;
};

/// Writes the tables of the whole list.
void writeSummary(const BatchList& list, const BatchFolder& folder, const BatchArguments& arguments) {
  const std::vector<BatchRow> rows = batchRows(list, folder, arguments.against);
  const std::string markdown = writeBatchTables(rows, folder);
  if (!arguments.work.quiet) fmt::print("{}", markdown);
  if (!arguments.only_summary) return;
  const auto failed =
      std::count_if(rows.begin(), rows.end(), [](const BatchRow& row) { return row.status == "failed"; });
  if (failed > 0) throw BatchError(fmt::format("{} of {}; table.md says why", failed, rows.size()));
}

void runBatch(const BatchArguments& arguments) {
  if (!arguments.against.empty() && !std::filesystem::is_directory(arguments.against)) {
    throw UsageError(fmt::format("--against {}: there is no such folder", arguments.against));
  }
  const BatchList list = readBatchList(arguments.list);
  const BatchFolder folder(arguments.output);
  if (arguments.only_summary) return writeSummary(list, folder, arguments);
  const BatchCounts counts = workOnBatch(list, folder, arguments.work);
  writeSummary(list, folder, arguments);
  if (!arguments.work.quiet) {
    fmt::print(stderr, "made {}, kept {}, failed {}, left to others {}\n", counts.made, counts.kept,
               counts.failed, counts.elsewhere);
  }
  if (counts.failed > 0) {
    throw BatchError(fmt::format("{} of {}; table.md says why", counts.failed,
                                 counts.made + counts.kept + counts.failed + counts.elsewhere));
  }
}

}  // namespace

void addBatchRunOptions(BatchWork* work, CLI::App* command) {
  command->add_option("--jobs", work->jobs, "number of runs at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--retry", work->retry, "make items again that failed before");
}

void addBatchWorkOptions(BatchWork* work, CLI::App* command) {
  command
      ->add_option_function<std::string>(
          "--shard", [work](const std::string& text) { work->shard = batchShardFromText(text); },
          "make only part I of N of the items")
      ->type_name("I/N")
      ->default_str("1/1");
  addBatchRunOptions(work, command);
  command->add_flag_callback(
      "--no-wait", [work] { work->wait = false; }, "end where other processes still work on items");
  command
      ->add_option("--stale-after-s", work->stale_after_s,
                   "age after which a lock of another machine is taken over")
      ->check(CLI::Range(60.0, 1e6))
      ->capture_default_str();
  command->add_flag("-q,--quiet", work->quiet, "no progress and no table");
}

void addBatchCommand(CLI::App& program) {
  const auto arguments = std::make_shared<BatchArguments>();
  CLI::App* command =
      program.add_subcommand("batch", "Run many recordings with several settings, on one or many machines");
  command->add_option("LIST", arguments->list, "YAML list of recordings, variants and seeds")->required();
  command->add_option("-o,--output", arguments->output, "folder for the results; made where it is missing")
      ->required();
  addBatchWorkOptions(&arguments->work, command);
  command->add_flag("--summary", arguments->only_summary, "write the tables and run nothing");
  command->add_option("--against", arguments->against, "output folder of another batch to compare with");
  command->footer(kBatchFooter);
  command->callback([arguments] { runBatch(*arguments); });
}

}  // namespace lodeline

#pragma once

#include <CLI/App.hpp>
#include <stdexcept>

#include "apps/lodeline/batch/batch_worker.h"

namespace lodeline {

/// Some items of a batch failed; the others are complete. The program ends with exit code 1.
class BatchError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Adds --jobs and --retry. `work` must live as long as the command.
void addBatchRunOptions(BatchWork* work, CLI::App* command);

/// Adds the options on how one process works on a batch. `work` must live as long as the command.
void addBatchWorkOptions(BatchWork* work, CLI::App* command);

/// `lodeline batch LIST.yaml -o OUT`: many runs, shared between processes and machines. Its callback throws
/// UsageError, InputError, BatchError and Interruption.
void addBatchCommand(CLI::App& program);

}  // namespace lodeline

#pragma once

#include <CLI/App.hpp>
#include <stdexcept>

namespace lodeline {

/// Some items of a batch failed; the others are complete. The program ends with exit code 1.
class BatchError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// `lodeline batch LIST.yaml -o OUT`: many runs, shared between processes and machines. Its callback throws
/// UsageError, InputError, BatchError and Interruption.
void addBatchCommand(CLI::App& program);

}  // namespace lodeline

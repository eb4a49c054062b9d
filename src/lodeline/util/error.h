#pragma once

#include <stdexcept>
#include <string>

namespace lodeline {

/// Error for input that cannot be used: a file is missing, damaged or contradicts another file. The message
/// names the file, the line or time stamp, the value found and the remedy. The program ends with exit code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Error for a wrong command line or configuration. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Error for readable input from which no trajectory could be estimated. Exit code 3.
class EstimationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lodeline

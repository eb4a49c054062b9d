#pragma once

#include <stdexcept>
#include <string>

namespace lodeline {

/// What the user gave cannot be used: a file is missing, damaged or contradicts another. The message names
/// the file, the line or time stamp, what was found and what to do. The program ends with exit code 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The command line or configuration is wrong. Exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The input was readable but no trajectory could be estimated from it. Exit code 3.
class EstimationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lodeline

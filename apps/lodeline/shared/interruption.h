#pragma once

#include <stdexcept>

namespace lodeline {

/// The user ended the work before it was done; what was done until then is complete on the disk. The program
/// ends with exit code 130, as any does that Ctrl-C ends.
class Interruption : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lodeline

#pragma once

#include <stdexcept>

namespace lodeline {

/// Thrown when the user has ended the work early; the results until then are complete on the disk. The
/// program ends with exit code 130, as usual after Ctrl-C.
class Interruption : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace lodeline

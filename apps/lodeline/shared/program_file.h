#pragma once

#include <cstdint>
#include <string_view>

namespace lodeline {

/// FNV-1a hash of bytes, 64 bit.
uint64_t hashOfBytes(std::string_view bytes);

/// Identifies the build of the running program: the hash of the program file.
uint64_t programFingerprint();

}  // namespace lodeline

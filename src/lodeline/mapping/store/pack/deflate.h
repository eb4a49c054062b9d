#pragma once

#include <span>
#include <vector>

namespace lodeline {

/// Compresses with deflate (RFC 1951), without header and check sum.
std::vector<unsigned char> deflated(std::span<const unsigned char> bytes);

/// The inverse of deflated(). Throws InputError where the result does not have `size` bytes.
std::vector<unsigned char> inflated(std::span<const unsigned char> bytes, size_t size);

}  // namespace lodeline

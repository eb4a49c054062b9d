#pragma once

#include <cstddef>
#include <string_view>

namespace lodeline {

/// Fewest single-character insertions, deletions and substitutions that turn one text into the other
/// (Levenshtein).
size_t editDistance(std::string_view a, std::string_view b);

}  // namespace lodeline

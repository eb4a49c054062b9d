#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace lodeline {

bool equalIgnoringCase(std::string_view a, std::string_view b);

/// The element of `names` with the smallest edit distance to `word`. Returns an empty string where the
/// distance of every name exceeds both one letter and a third of the letters.
std::string nearestName(std::string_view word, std::span<const std::string> names);

/// "; did you mean 'NAME'?" with nearestName(word, names); empty where there is no near name.
std::string didYouMean(std::string_view word, std::span<const std::string> names);

/// Index of `word` in `names`, ignoring case. `what` names the place of the word in error messages. Throws
/// UsageError that lists the names and suggests the nearest one.
size_t chooseByName(std::string_view what, std::string_view word, std::span<const std::string> names);

}  // namespace lodeline

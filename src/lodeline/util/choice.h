#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace lodeline {

bool equalIgnoringCase(std::string_view a, std::string_view b);

/// The name of `names` that is nearest to `word` in letters; empty where none is near: more than a third of
/// the letters, and more than one, differ.
std::string nearestName(std::string_view word, std::span<const std::string> names);

/// "; did you mean 'NAME'?" with the nearest of `names`; empty where none is near.
std::string didYouMean(std::string_view word, std::span<const std::string> names);

/// Index of `word` in `names`, without regard to case. `what` says where the word was given, for messages.
/// Throws UsageError that lists the names and suggests the nearest.
size_t chooseByName(std::string_view what, std::string_view word, std::span<const std::string> names);

}  // namespace lodeline

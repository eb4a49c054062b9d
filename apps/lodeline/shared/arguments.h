#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lodeline {

/// The words of the command line with places (`--site`, `--entrance`) as one word each, whether their three
/// numbers were given with commas, with blanks, or as three words: LAT,LON,HEIGHT.
std::vector<std::string> withJoinedPlaces(const std::vector<std::string>& words);

/// Throws UsageError, suggesting the nearest name, where `words` begin with no command of `program`, or name
/// an option that the command does not have.
void refuseUnknownWords(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace lodeline

#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lodeline {

/// Replaces `help COMMAND` by `COMMAND --help`, and `help` alone by `--help`. Returns other arguments
/// unchanged.
std::vector<std::string> withHelpAsOption(std::vector<std::string> words);

/// The words of the command line with each position (`--site`, `--entrance`) as one word LAT,LON,HEIGHT. Its
/// three numbers may be separated by commas or blanks, or be three words.
std::vector<std::string> withJoinedPlaces(const std::vector<std::string>& words);

/// Throws UsageError, with the nearest name as a suggestion, where `words` begin with an unknown command of
/// `program` or contain an unknown option.
void refuseUnknownWords(const CLI::App& program, const std::vector<std::string>& words);

}  // namespace lodeline

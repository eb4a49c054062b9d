#include "apps/lodeline/shared/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/util/choice.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

constexpr size_t kNumbersOfPlace = 3;

/// Parts of `text` between commas and blanks.
std::vector<std::string> partsOf(const std::string& text) {
  std::vector<std::string> parts;
  for (size_t begin = 0; (begin = text.find_first_not_of(", \t", begin)) != std::string::npos;) {
    const size_t end = std::min(text.find_first_of(", \t", begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return parts;
}

bool isNumber(const std::string& text) {
  double number = 0.0;
  return csv::parse(text, &number);
}

bool areNumbers(const std::string& word) {
  const std::vector<std::string> parts = partsOf(word);
  return !parts.empty() && std::all_of(parts.begin(), parts.end(), isNumber);
}

/// Joins up to three numbers to the position that starts with `value`; `next` moves past the words used.
std::string placeFrom(std::string value, const std::vector<std::string>& words, size_t* next) {
  while (areNumbers(value) && partsOf(value).size() < kNumbersOfPlace && *next < words.size() &&
         areNumbers(words[*next])) {
    value += ",";
    value += words[(*next)++];
  }
  return areNumbers(value) ? fmt::format("{}", fmt::join(partsOf(value), ",")) : value;
}

std::vector<std::string> commandsOf(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> optionsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::vector<std::string> withHelpAsOption(std::vector<std::string> words) {
  if (words.empty() || words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

std::vector<std::string> withJoinedPlaces(const std::vector<std::string>& words) {
  std::vector<std::string> joined;
  for (size_t i = 0; i < words.size();) {
    const std::string& word = words[i++];
    const size_t equals = word.find('=');
    const std::string name = word.substr(0, equals);
    const bool takes_place = name == "--site" || name == "--entrance" || name == "--background-at";
    if (takes_place && equals != std::string::npos) {
      joined.push_back(name + "=" + placeFrom(word.substr(equals + 1), words, &i));
    } else if (takes_place && i < words.size() && areNumbers(words[i])) {
      const size_t value = i++;
      // With an equals sign a negative latitude does not look like an option.
      joined.push_back(name + "=" + placeFrom(words[value], words, &i));
    } else {
      joined.push_back(word);
    }
  }
  return joined;
}

void refuseUnknownWords(const CLI::App& program, const std::vector<std::string>& words) {
  if (words.empty() || words[0].starts_with('-')) return;
  const std::vector<std::string> commands = commandsOf(program);
  if (std::find(commands.begin(), commands.end(), words[0]) == commands.end()) {
    throw UsageError(fmt::format("unknown command '{}'{}; the commands are {}", words[0],
                                 didYouMean(words[0], commands), fmt::join(commands, ", ")));
  }
  const CLI::App* command = program.get_subcommand(words[0]);
  // Subcommands of commands (`calibrate magnetometer`).
  for (size_t i = 1; i < words.size() && !command->get_subcommands({}).empty(); ++i) {
    if (words[i].starts_with('-')) continue;
    const std::vector<std::string> inner = commandsOf(*command);
    if (std::find(inner.begin(), inner.end(), words[i]) == inner.end()) {
      throw UsageError(fmt::format("{} {}: one of {} is wanted{}", words[0], words[i], fmt::join(inner, ", "),
                                   didYouMean(words[i], inner)));
    }
    command = command->get_subcommand(words[i]);
  }
  const std::vector<std::string> options = optionsOf(*command);
  for (const std::string& word : words) {
    if (word == "--") return;
    if (!word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    if (std::find(options.begin(), options.end(), name) != options.end()) continue;
    throw UsageError(fmt::format("unknown option '{}' of `{}`{}; `lodeline {} --help` lists them", name,
                                 command->get_name(), didYouMean(name, options), words[0]));
  }
}

}  // namespace lodeline

#include "apps/lodeline/program/help_formatter.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "apps/lodeline/program/help_groups.h"
#include "lodeline/util/terminal/terminal.h"

namespace lodeline {
namespace {

constexpr size_t kLongestLine = 100;
constexpr size_t kColumn = 28;  ///< where descriptions begin
constexpr size_t kIndent = 2;

/// Titles of the groups of a command's options: those that other commands do not have, then the shared ones.
std::vector<std::string> orderedGroups(const CLI::App& command) {
  const std::vector<std::string> shared = optionGroupTitles();
  std::vector<std::string> groups = command.get_groups();
  std::erase_if(groups, [&](const std::string& group) {
    return group.empty() || std::find(shared.begin(), shared.end(), group) != shared.end();
  });
  groups.insert(groups.end(), shared.begin(), shared.end());
  return groups;
}

/// Placeholder for the value of an option in help texts, such as FILE, without its range.
std::string typeOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

}  // namespace

HelpFormatter::HelpFormatter()
    : HelpFormatter(std::min(kLongestLine, terminal::width(stdout).value_or(kLongestLine)),
                    terminal::hasColours(stdout)) {}

HelpFormatter::HelpFormatter(size_t width, bool in_colour) : width_(width), in_colour_(in_colour) {}

std::string HelpFormatter::title(const std::string& text) const {
  return "\n" + terminal::coloured(text + ":", terminal::Colour::Bold, in_colour_) + "\n";
}

std::string HelpFormatter::row(const std::string& left, const std::string& right) const {
  // On a narrow screen, descriptions begin below their options.
  const size_t column = width_ < 60 ? 2 * kIndent : kColumn;
  std::string text = std::string(kIndent, ' ') + left;
  if (right.empty()) return text + "\n";
  if (text.size() + kIndent > column) {
    text += "\n" + std::string(column, ' ');
  } else {
    text.append(column - text.size(), ' ');
  }
  return text + terminal::wrapped(right, width_, column, column) + "\n";
}

std::string HelpFormatter::make_help(const CLI::App* command, std::string name,
                                     CLI::AppFormatMode mode) const {
  std::string text =
      make_description(command) + make_usage(command, std::move(name)) + make_positionals(command);
  for (const std::string& group : orderedGroups(*command)) {
    const std::vector<const CLI::Option*> options = command->get_options(
        [&](const CLI::Option* option) { return option->get_group() == group && !option->get_positional(); });
    if (!options.empty()) text += make_group(group, false, options);
  }
  return text + make_subcommands(command, mode) + "\n" + make_footer(command);
}

std::string HelpFormatter::make_group(std::string group, bool is_positional,
                                      std::vector<const CLI::Option*> options) const {
  std::string text = title(group == "Positionals" ? std::string("Arguments") : std::move(group));
  for (const CLI::Option* option : options) text += make_option(option, is_positional);
  return text;
}

std::string HelpFormatter::make_subcommands(const CLI::App* command, CLI::AppFormatMode) const {
  std::string text, group;
  for (const CLI::App* inner : command->get_subcommands({})) {
    if (inner->get_group().empty()) continue;  // hidden
    if (inner->get_group() != group) {
      group = inner->get_group();
      text += title(group == "Subcommands" ? "Commands" : group);
    }
    text += make_subcommand(inner);
  }
  return text;
}

std::string HelpFormatter::make_usage(const CLI::App* command, std::string name) const {
  std::string text = name.empty() ? command->get_name() : name;
  const auto isVisible = [](const CLI::Option* option) { return !option->get_group().empty(); };
  for (const CLI::Option* option : command->get_options(isVisible)) {
    if (option->get_positional()) {
      const std::string positional = option->get_name(true, false);
      const std::string more = option->get_items_expected_max() > 1 ? " ..." : "";
      text += option->get_required() ? fmt::format(" {}{}", positional, more)
                                     : fmt::format(" [{}{}]", positional, more);
    } else if (option->get_required()) {
      text += fmt::format(" {} {}", option->get_name(false, false), typeOf(*option));
    }
  }
  if (!command->get_subcommands({}).empty()) text += " COMMAND";
  return "\n" + terminal::coloured("Usage:", terminal::Colour::Bold, in_colour_) + " " +
         terminal::wrapped(text + " [OPTIONS]", width_, 7, 11) + "\n";
}

std::string HelpFormatter::make_description(const CLI::App* command) const {
  const std::string text = command->get_description();
  return text.empty() ? "" : terminal::wrapped(text, width_, 0, 0) + "\n";
}

std::string HelpFormatter::make_footer(const CLI::App* command) const {
  std::string text, rest = command->get_footer();
  // Lines of examples keep their indent where they are continued.
  while (!rest.empty()) {
    const size_t end = std::min(rest.find('\n'), rest.size());
    const std::string line = rest.substr(0, end);
    const size_t indent = std::min(line.find_first_not_of(' '), line.size());
    text += terminal::wrapped(line, width_, 0, indent == 0 ? 0 : indent + 2 * kIndent) + "\n";
    rest.erase(0, end + 1);
  }
  return text;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return row(optionUsage(*option, is_positional), optionDescription(*option));
}

std::string HelpFormatter::make_subcommand(const CLI::App* command) const {
  return row(command->get_name(), command->get_description());
}

std::string optionUsage(const CLI::Option& option, bool is_positional) {
  std::string text;
  for (const char c : option.get_name(is_positional, !is_positional))
    text += c == ',' ? ", " : std::string(1, c);
  if (is_positional || option.get_items_expected_max() == 0) return text;
  text += " " + typeOf(option);
  return option.get_items_expected_min() == 0 ? text + " (optional)" : text;
}

std::string optionDescription(const CLI::Option& option) {
  std::string text = option.get_description();
  const std::string standard = option.get_default_str();
  const bool says_nothing = standard.empty() || standard == "[]" || standard == "\"\"" || standard == "false";
  if (option.get_items_expected_max() > 0 && !says_nothing) text += fmt::format(" (default: {})", standard);
  return text;
}

}  // namespace lodeline

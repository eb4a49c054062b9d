#include "apps/lodeline/program/shell_completion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "apps/lodeline/program/command_tree.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Names of the commands below `command`.
std::vector<std::string> innerNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* inner : command.get_subcommands({})) names.push_back(inner->get_name());
  return names;
}

/// Line of a bash case for the words of a command, and of the commands below it.
void addCases(const CLI::App& command, const std::string& words, std::string* cases) {
  std::vector<std::string> proposals = innerNames(command);
  for (const std::string& name : optionNames(command)) {
    if (name.starts_with("--")) proposals.push_back(name);
  }
  *cases += fmt::format("    '{}') proposals='{}' ;;\n", words, fmt::join(proposals, " "));
  for (const CLI::App* inner : command.get_subcommands({})) {
    addCases(*inner, words.empty() ? inner->get_name() : words + " " + inner->get_name(), cases);
  }
}

/// Commands that have further commands below them.
std::vector<std::string> groups(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* inner : program.get_subcommands({})) {
    if (!inner->get_subcommands({}).empty()) names.push_back(inner->get_name());
  }
  return names;
}

constexpr const char* kBash = R"(# Completion of lodeline for bash.
_lodeline() {{
  local current="${{COMP_WORDS[COMP_CWORD]}}" words='' proposals=''
  if [ "$COMP_CWORD" -gt 1 ]; then words="${{COMP_WORDS[1]}}"; fi
  case "$words" in
    {}) if [ "$COMP_CWORD" -gt 2 ]; then words="$words ${{COMP_WORDS[2]}}"; fi ;;
  esac
  case "$words" in
{}  esac
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ] || [[ "$current" == -* ]] || [[ "$words" =~ ^({})$ ]]; then
    COMPREPLY=($(compgen -W "$proposals" -- "$current"))
  fi
}}
complete -o default -o bashdefault -F _lodeline lodeline
)";

std::string bashScript(const CLI::App& program) {
  std::string cases;
  addCases(program, "", &cases);
  const std::vector<std::string> with_inner = groups(program);
  return fmt::format(kBash, fmt::join(with_inner, "|"), cases, fmt::join(with_inner, "|"));
}

/// Text within single quotes of fish, on one line.
std::string fishQuoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result + "'";
}

std::string fishCondition(const std::vector<std::string>& words) {
  std::string condition;
  for (const std::string& word : words)
    condition += (condition.empty() ? "" : "; and ") + std::string("__fish_seen_subcommand_from ") + word;
  return condition.empty() ? "__fish_use_subcommand" : condition;
}

std::string fishScript(const CLI::App& program) {
  std::string script = "# Completion of lodeline for fish.\n";
  for (const CLI::App* command : program.get_subcommands({})) {
    script += fmt::format("complete -c lodeline -f -n __fish_use_subcommand -a {} -d {}\n",
                          command->get_name(), fishQuoted(command->get_description()));
    for (const CLI::App* inner : command->get_subcommands({})) {
      script +=
          fmt::format("complete -c lodeline -f -n '{}' -a {} -d {}\n", fishCondition({command->get_name()}),
                      inner->get_name(), fishQuoted(inner->get_description()));
    }
  }
  for (const LeafCommand& leaf : leafCommands(program)) {
    for (const CLI::Option* option : leaf.command->get_options()) {
      if (option->get_lnames().empty()) continue;
      script += fmt::format("complete -c lodeline -n '{}' -l {}{} -d {}\n", fishCondition(leaf.words),
                            option->get_lnames().front(), option->get_items_expected_max() > 0 ? " -r" : "",
                            fishQuoted(option->get_description()));
    }
  }
  return script;
}

}  // namespace

std::string completionScript(const CLI::App& program, const std::string& shell) {
  if (shell == "bash") return bashScript(program);
  // zsh runs bash's completion functions.
  if (shell == "zsh") return "autoload -U +X bashcompinit && bashcompinit\n" + bashScript(program);
  if (shell == "fish") return fishScript(program);
  throw UsageError(fmt::format("completion {}: must be bash, zsh or fish", shell));
}

void addCompletionCommand(CLI::App& program) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      program.add_subcommand("completion", "Print the script that completes commands in a shell");
  command->add_option("SHELL", *shell, "bash, zsh or fish")->required();
  command->footer(
      "Examples:\n"
      "  source <(lodeline completion bash)\n"
      "  lodeline completion fish > ~/.config/fish/completions/lodeline.fish");
  command->callback([shell, &program] { fmt::print("{}", completionScript(program, *shell)); });
}

}  // namespace lodeline

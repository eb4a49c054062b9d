#include "apps/lodeline/program/command_tree.h"

namespace lodeline {
namespace {

void collect(const CLI::App& command, const std::vector<std::string>& words,
             std::vector<LeafCommand>* leaves) {
  const std::vector<const CLI::App*> inner = command.get_subcommands({});
  if (inner.empty()) leaves->push_back({words, &command});
  for (const CLI::App* next : inner) {
    std::vector<std::string> longer = words;
    longer.push_back(next->get_name());
    collect(*next, longer, leaves);
  }
}

}  // namespace

std::vector<LeafCommand> leafCommands(const CLI::App& program) {
  std::vector<LeafCommand> leaves;
  collect(program, {}, &leaves);
  return leaves;
}

std::vector<std::string> optionNames(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace lodeline

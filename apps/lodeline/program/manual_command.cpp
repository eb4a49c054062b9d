#include "apps/lodeline/program/manual_command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <memory>
#include <sstream>
#include <string_view>

#include "apps/lodeline/program/help_formatter.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

/// Text whose characters roff shows unchanged.
std::string escaped(std::string_view text) {
  std::string result;
  bool at_line_start = true;
  for (const char c : text) {
    if (at_line_start && (c == '.' || c == '\'')) result += "\\&";
    at_line_start = c == '\n';
    if (c == '\\') {
      result += "\\e";
    } else if (c == '-') {
      result += "\\-";
    } else {
      result += c;
    }
  }
  return result;
}

std::string heading(const std::string& name, const std::string& version) {
  return fmt::format(".TH \"{}\" 1 \"\" \"lodeline {}\" \"Lodeline\"\n", escaped(name), version);
}

std::string nameSection(const std::string& name, const std::string& description) {
  return fmt::format(".SH NAME\n{} \\- {}\n", escaped(name), escaped(description));
}

void addOptions(const CLI::App& command, bool positionals, const char* title, std::string* page) {
  std::string rows;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional() != positionals || option->get_group().empty()) continue;
    rows += fmt::format(".TP\n.B {}\n{}\n", escaped(optionUsage(*option, positionals)),
                        escaped(optionDescription(*option)));
  }
  if (!rows.empty()) *page += fmt::format(".SH {}\n{}", title, rows);
}

std::string synopsis(const CLI::App& command, const std::string& name) {
  std::string text = fmt::format(".SH SYNOPSIS\n.B {}\n", escaped(name));
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) text += escaped(option->get_name(true, false)) + "\n";
  }
  return text + "[OPTIONS]\n";
}

}  // namespace

std::string manualPage(const LeafCommand& leaf, const std::string& version) {
  const CLI::App& command = *leaf.command;
  std::string page = heading(fmt::format("lodeline-{}", fmt::join(leaf.words, "-")), version);
  page += nameSection(fmt::format("lodeline-{}", fmt::join(leaf.words, "-")), command.get_description());
  page += synopsis(command, fmt::format("lodeline {}", fmt::join(leaf.words, " ")));
  addOptions(command, true, "ARGUMENTS", &page);
  addOptions(command, false, "OPTIONS", &page);
  if (!command.get_footer().empty()) {
    page += fmt::format(".SH NOTES\n.nf\n{}\n.fi\n", escaped(command.get_footer()));
  }
  return page + ".SH SEE ALSO\n.BR lodeline (1)\n";
}

std::string manualIndex(const CLI::App& program, const std::string& version) {
  std::string page = heading("lodeline", version) + nameSection("lodeline", program.get_description());
  page += ".SH SYNOPSIS\n.B lodeline\nCOMMAND [OPTIONS]\n.SH COMMANDS\n";
  for (const LeafCommand& leaf : leafCommands(program)) {
    page +=
        fmt::format(".TP\n.BR {} (1)\n{}\n", escaped(fmt::format("lodeline-{}", fmt::join(leaf.words, "-"))),
                    escaped(leaf.command->get_description()));
  }
  addOptions(program, false, "OPTIONS", &page);
  return page;
}

void addManualCommand(CLI::App& program) {
  const auto folder = std::make_shared<std::string>();
  CLI::App* command = program.add_subcommand("manual", "Write the pages for `man`");
  command->add_option("-o,--output", *folder, "folder for the pages; made where it is missing")
      ->type_name("FOLDER")
      ->required();
  command->footer("Example:\n  lodeline manual -o ~/.local/share/man/man1");
  command->callback([folder, &program] {
    const std::filesystem::path pages = *folder;
    createOutputFolder(pages);
    writeOutput(pages / "lodeline.1", manualIndex(program, LODELINE_VERSION));
    for (const LeafCommand& leaf : leafCommands(program)) {
      writeOutput(pages / fmt::format("lodeline-{}.1", fmt::join(leaf.words, "-")),
                  manualPage(leaf, LODELINE_VERSION));
    }
  });
}

}  // namespace lodeline

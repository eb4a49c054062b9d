#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstddef>
#include <string>

namespace lodeline {

/// Help texts in the width of the terminal, at most 100 columns: a column of options, and beside it the
/// description with the default value. Titles are bold on a terminal.
class HelpFormatter : public CLI::Formatter {
 public:
  /// Takes width and colours from the standard output stream.
  HelpFormatter();
  HelpFormatter(size_t width, bool in_colour);

  std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override;
  std::string make_subcommands(const CLI::App* command, CLI::AppFormatMode mode) const override;
  std::string make_usage(const CLI::App* command, std::string name) const override;
  std::string make_description(const CLI::App* command) const override;
  std::string make_footer(const CLI::App* command) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::string title(const std::string& text) const;
  std::string row(const std::string& left, const std::string& right) const;

  size_t width_;
  bool in_colour_;
};

/// Names of an option and its value: "-o,--output FOLDER".
std::string optionUsage(const CLI::Option& option, bool is_positional);

/// Description of an option, with what it requires and its default: "camera to use (default: 0)".
std::string optionDescription(const CLI::Option& option);

}  // namespace lodeline

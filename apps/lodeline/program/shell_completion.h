#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

namespace lodeline {

/// Script that completes commands, options and file names of `program` in a shell: bash, zsh or fish. Throws
/// UsageError for another shell.
std::string completionScript(const CLI::App& program, const std::string& shell);

/// Adds `lodeline completion SHELL`, which prints the script.
void addCompletionCommand(CLI::App& program);

}  // namespace lodeline

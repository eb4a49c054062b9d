#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>

#include "apps/lodeline/program/command_tree.h"

namespace lodeline {

/// The page of a command for `man`, in roff.
std::string manualPage(const LeafCommand& leaf, const std::string& version);

/// The page `lodeline(1)`, which lists the commands.
std::string manualIndex(const CLI::App& program, const std::string& version);

/// Adds `lodeline manual -o FOLDER`, which writes all pages.
void addManualCommand(CLI::App& program);

}  // namespace lodeline

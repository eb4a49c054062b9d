#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <vector>

namespace lodeline {

/// Sorts commands and options of help texts into groups with titles: an option has the same group in every
/// command. Others stay in the group "Options".
void makeHelpGroups(CLI::App& program);

/// Titles of the groups of options, in the order of a help text.
std::vector<std::string> optionGroupTitles();

}  // namespace lodeline

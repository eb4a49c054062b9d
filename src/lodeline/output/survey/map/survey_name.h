#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lodeline {

/// The name with every character replaced by '_' that Survex or Therion refuses in names: all but ASCII
/// letters, digits, '_' and '-', and a '-' in front. At most 64 characters; "dive" where nothing is left.
std::string surveyName(const std::string& name);

/// A name for each run folder: the last part of its path; where several are equal, with the parts before it
/// until they differ ("monday_out", "tuesday_out"), else with a number. Survex does not tell upper from lower
/// case, so neither does the comparison.
std::vector<std::string> surveyNames(const std::vector<std::filesystem::path>& folders);

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lodeline {

/// The name with '_' in place of every character that Survex or Therion does not allow in names: all except
/// ASCII letters, digits, '_' and '-', and a leading '-'. At most 64 characters; "dive" where nothing is
/// left.
std::string surveyName(const std::string& name);

/// Names of run folders: the last component of their paths. Equal ones get the components before it until
/// they differ ("monday_out", "tuesday_out"), else a number. The comparison ignores case, as Survex does.
std::vector<std::string> surveyNames(const std::vector<std::filesystem::path>& folders);

}  // namespace lodeline

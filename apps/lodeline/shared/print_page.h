#pragma once

#include <filesystem>
#include <string>

namespace lodeline {

/// Prints a page of `lodeline report` to a PDF file by Chromium, which draws without a window.
/// `environment_path`: the folders to look for it, as in the variable PATH. Throws UsageError where there is
/// no Chromium, InputError where it fails or writes no PDF within two minutes.
void printPage(const std::string& page, const std::filesystem::path& pdf,
               const std::string& environment_path);

}  // namespace lodeline

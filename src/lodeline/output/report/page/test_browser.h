#pragma once

#include <string>

/// Pages in headless Chromium; the scripts in web/test say what is tried there.
namespace lodeline::test {

/// Why pages cannot be tried here; empty where they can.
std::string browserMissing();

/// Runs a script of web/test on a page, given by its file or address; what fails is printed.
bool passesInBrowser(const std::string& script, const std::string& page);

}  // namespace lodeline::test

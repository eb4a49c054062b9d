#pragma once

#include <string>

/// Tests of pages in headless Chromium; the scripts in web/test contain the checks.
namespace lodeline::test {

/// Reason why pages cannot be tested on this machine; empty where they can.
std::string browserMissing();

/// Runs a script of web/test on a page, given by its file or address; prints failures.
bool passesInBrowser(const std::string& script, const std::string& page);

}  // namespace lodeline::test

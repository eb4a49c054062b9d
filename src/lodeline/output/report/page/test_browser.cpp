#include "lodeline/output/report/page/test_browser.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <cstdlib>

#include "lodeline/output/report/page/page_template.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline::test {
namespace {

bool succeeds(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::string browserMissing() {
  if (pageTemplate().empty()) return "built without the report page";
  if (!succeeds("command -v chromium >/dev/null 2>&1")) return "chromium is not installed";
  return "";
}

bool passesInBrowser(const std::string& script, const std::string& page) {
  return succeeds(fmt::format("cd '{}' && '{}' {} '{}'", (testSourceDir() / "web" / "test").string(),
                              LODELINE_NODE, script, page));
}

}  // namespace lodeline::test

#include "apps/lodeline/shared/print_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

class PrintPage : public testing::Test {
 protected:
  /// A program of this content under the name of the browser, alone in its folder.
  std::string browserThat(const std::string& script) const {
    const fs::path program = folder_.path() / "chromium";
    std::ofstream(program) << "#!/bin/sh\n" << script;
    fs::permissions(program, fs::perms::owner_all);
    return folder_.path().string();
  }
  std::string errorOf(const std::string& path) const {
    try {
      printPage("<p>page</p>", pdf(), path);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
  fs::path pdf() const { return folder_.path() / "out.pdf"; }
  TemporaryFolder folder_;
};

TEST_F(PrintPage, WithoutABrowserNamesThePackage) {
  EXPECT_THROW(printPage("", pdf(), folder_.path().string()), UsageError);
  EXPECT_THAT(errorOf(folder_.path().string()), AllOf(HasSubstr("package chromium"), HasSubstr("--pdf")));
}

TEST_F(PrintPage, TellsWhatABrowserSaysThatFails) {
  EXPECT_THAT(errorOf(browserThat("echo 'no room on the disk' >&2\nexit 3\n")),
              HasSubstr("no room on the disk"));
  EXPECT_FALSE(fs::exists(pdf()));
  // One that ends well but writes nothing.
  EXPECT_THAT(errorOf(browserThat("exit 0\n")), HasSubstr("printed nothing"));
}

TEST_F(PrintPage, GivesThePageAndTakesThePdf) {
  const std::string path = browserThat(
      "for word in \"$@\"; do\n  case $word in\n    --print-to-pdf=*) pdf=${word#*=};;\n    file://*) "
      "page=${word#file://};;\n"
      "  esac\ndone\nprintf '%%PDF ' > \"$pdf\"\n/bin/cat \"${page%#print}\" >> \"$pdf\"\n");
  EXPECT_EQ(errorOf(path), "");
  std::ifstream stream(pdf());
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  EXPECT_EQ(text, "%PDF <p>page</p>");
}

}  // namespace
}  // namespace lodeline

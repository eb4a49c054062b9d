#include "apps/lodeline/shared/print_page.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

#include "apps/lodeline/shared/scratch_folder.h"
#include "lodeline/diagnostics.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kLongest(120);

/// Names under which systems install it.
constexpr std::array<const char*, 5> kNames = {"chromium", "chromium-browser", "google-chrome",
                                               "google-chrome-stable", "chrome"};

std::optional<fs::path> findBrowser(const std::string& environment_path) {
  for (const char* name : kNames) {
    std::istringstream folders(environment_path);
    for (std::string folder; std::getline(folders, folder, ':');) {
      const fs::path program = fs::path(folder.empty() ? "." : folder) / name;
      if (access(program.c_str(), X_OK) == 0 && fs::is_regular_file(program)) return program;
    }
  }
  return std::nullopt;
}

std::vector<std::string> commandLine(const fs::path& browser, const fs::path& folder) {
  std::vector<std::string> words = {
      browser.string(), "--headless=new", "--disable-extensions", "--no-first-run",
      // Drawing in space without a graphics card.
      "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--window-size=1000,1400",
      "--virtual-time-budget=30000", "--no-pdf-header-footer",
      "--user-data-dir=" + (folder / "profile").string(), "--print-to-pdf=" + (folder / "page.pdf").string()};
  // Chromium refuses to isolate its processes for root, as in a container; the page is the program's own.
  if (geteuid() == 0) words.insert(words.begin() + 1, "--no-sandbox");
  words.push_back("file://" + (folder / "page.html").string() + "#print");
  return words;
}

/// Starts a program in a new process group, its messages going to a file.
pid_t start(const std::vector<std::string>& words, const fs::path& messages) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child != 0) return child;
  setpgid(0, 0);
  const int file = open(messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  execv(arguments[0], arguments.data());
  _exit(127);
}

/// Whether the child ended with exit code 0 in time; one that takes longer is killed with its children.
bool endsWell(pid_t child) {
  const auto end = std::chrono::steady_clock::now() + kLongest;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string readFile(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string lastLine(const std::string& text) {
  const size_t last = text.find_last_not_of('\n');
  if (last == std::string::npos) return "it says nothing";
  const size_t before = text.find_last_of('\n', last);
  const size_t first = before == std::string::npos ? 0 : before + 1;
  return text.substr(first, last + 1 - first);
}

}  // namespace

void printPage(const std::string& page, const fs::path& pdf, const std::string& environment_path) {
  const std::optional<fs::path> browser = findBrowser(environment_path);
  if (!browser) {
    throw UsageError(
        "--pdf: Chromium prints the page, and no program 'chromium' or 'google-chrome' was found; install "
        "the package "
        "chromium (Debian: apt-get install chromium), or open the page in any browser and print it from "
        "there");
  }
  const ScratchFolder scratch;
  writeOutput(scratch.path() / "page.html", page);
  const pid_t child = start(commandLine(*browser, scratch.path()), scratch.path() / "messages");
  if (child < 0) throw InputError("--pdf: no process can be started for " + browser->string());
  const bool ended_well = endsWell(child);
  const std::string content = readFile(scratch.path() / "page.pdf");
  if (!ended_well || content.rfind("%PDF", 0) != 0) {
    throw InputError(fmt::format("--pdf: {} printed nothing: {}", browser->string(),
                                 lastLine(readFile(scratch.path() / "messages"))));
  }
  writeOutput(pdf, content);
}

}  // namespace lodeline

#include "apps/lodeline/batch/item_claim.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

std::string textOfFile(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// Where process numbers are comparable: host, boot of the kernel, and namespace of processes.
std::string processSpace() {
  std::error_code ignored;
  std::string boot = textOfFile("/proc/sys/kernel/random/boot_id");
  boot.erase(std::remove(boot.begin(), boot.end(), '\n'), boot.end());
  return hostName() + " " + boot + " " + fs::read_symlink("/proc/self/ns/pid", ignored).string();
}

/// Start of a running process in ticks since boot; empty where it has ended.
std::string processStart(int64_t pid) {
  const std::string stat = textOfFile(fmt::format("/proc/{}/stat", pid));
  const size_t name_end = stat.rfind(')');  // a name may contain blanks
  if (name_end == std::string::npos) return "";
  std::istringstream fields(stat.substr(name_end + 1));
  std::string field;
  constexpr int kStateField = 3;
  constexpr int kStartField = 22;
  for (int number = kStateField; fields >> field; ++number) {
    if (number == kStateField && (field == "Z" || field == "X")) return "";
    if (number == kStartField) return field;
  }
  return "";
}

std::string lockText() {
  const int64_t pid = getpid();
  return jsonText(
             nlohmann::ordered_json{
                 {"host", hostName()}, {"pid", pid}, {"start", processStart(pid)}, {"space", processSpace()}},
             -1) +
         "\n";
}

bool isLive(const fs::path& lock, double stale_after_s) {
  const double changed_s = changeTime_s(lock);
  if (changed_s == 0.0) return false;  // released
  constexpr bool kThrow = false;       // its process may still be writing it
  const auto json = nlohmann::json::parse(textOfFile(lock), nullptr, kThrow);
  if (json.is_object() && json.value("space", "") == processSpace()) {
    const std::string start = processStart(json.value("pid", int64_t{0}));
    return !start.empty() && start == json.value("start", "");
  }
  return fileSystemTime_s(lock.parent_path()) - changed_s < stale_after_s;
}

/// Numbers of the lock files in a folder.
std::vector<int> lockNumbers(const fs::path& folder) {
  std::vector<int> numbers;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; }) &&
        name.size() < 9) {
      numbers.push_back(std::stoi(name));
    }
  }
  return numbers;
}

fs::path lockFile(const fs::path& folder, int number) { return folder / std::to_string(number); }

/// Whether a process holds one of these locks.
bool isHeld(const fs::path& folder, const std::vector<int>& numbers, double stale_after_s) {
  return std::any_of(numbers.begin(), numbers.end(),
                     [&](int number) { return isLive(lockFile(folder, number), stale_after_s); });
}

}  // namespace

std::string processLabel() { return fmt::format("{}.{}", hostName(), getpid()); }

double changeTime_s(const fs::path& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) return 0.0;
  return static_cast<double>(status.st_mtim.tv_sec) + 1e-9 * static_cast<double>(status.st_mtim.tv_nsec);
}

double fileSystemTime_s(const fs::path& folder) {
  const fs::path file = folder / fmt::format("clock.{}", processLabel());
  writeOutput(file, "now\n");
  const double time_s = changeTime_s(file);
  std::error_code ignored;
  fs::remove(file, ignored);
  return time_s;
}

ItemClaim::ItemClaim(fs::path folder, int number, std::vector<int> stale)
    : folder_(std::move(folder)), number_(number), stale_(std::move(stale)) {}

std::unique_ptr<ItemClaim> ItemClaim::take(const fs::path& folder, double stale_after_s) {
  createOutputFolder(folder);
  const std::vector<int> numbers = lockNumbers(folder);
  if (isHeld(folder, numbers, stale_after_s)) return nullptr;
  const int number = numbers.empty() ? 1 : *std::max_element(numbers.begin(), numbers.end()) + 1;
  const fs::path file = lockFile(folder, number);
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    // Another process was faster, or has just released the item and removed the folder.
    if (errno == EEXIST || errno == ENOENT) return nullptr;
    throw InputError(file.string() + ": cannot be written; check the rights and the space of the folder");
  }
  std::unique_ptr<ItemClaim> claim(new ItemClaim(folder, number, numbers));
  const std::string text = lockText();
  const bool is_written = write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  close(descriptor);
  if (!is_written) throw InputError(file.string() + ": writing failed; is the disk full?");
  // Each process creates its lock before it looks for others, so two cannot both find none.
  std::vector<int> others = lockNumbers(folder);
  std::erase(others, number);
  if (!isHeld(folder, others, stale_after_s)) return claim;
  claim->stale_.clear();
  return nullptr;
}

ItemClaim::~ItemClaim() {
  std::error_code ignored;
  for (const int number : stale_) fs::remove(lockFile(folder_, number), ignored);
  fs::remove(lockFile(folder_, number_), ignored);
  fs::remove(folder_, ignored);  // fails, as it should, where another lock is there
}

void ItemClaim::renew() const { utimensat(AT_FDCWD, lockFile(folder_, number_).c_str(), nullptr, 0); }

}  // namespace lodeline

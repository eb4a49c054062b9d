#include "lodeline/evaluation/figures/gnuplot.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

namespace lodeline::gnuplot {
namespace {

constexpr std::size_t kMaxPoints = 4000;
constexpr int kShellCommandNotFound = 127;

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

std::string output(const Figure& figure, const std::filesystem::path& folder, const char* ending,
                   const std::string& terminal) {
  const std::filesystem::path file = folder / (figure.name + ending);
  return fmt::format("reset\nset terminal {}\nset output {}\n{}\nunset output\n", terminal,
                     quoted(file.string()), figure.commands);
}

std::string scriptFor(const std::vector<Figure>& figures, const std::filesystem::path& folder) {
  std::string script;
  for (const Figure& figure : figures) {
    script += output(figure, folder, ".png",
                     fmt::format("pngcairo size {},{} font 'Sans,15' linewidth 1.4 background '#ffffff'",
                                 figure.width_px, figure.height_px));
    script += output(figure, folder, ".svg",
                     fmt::format("svg size {},{} dynamic font 'Helvetica,Arial,sans-serif,20' linewidth 1.4 "
                                 "background '#ffffff'",
                                 figure.width_px, figure.height_px));
  }
  return script;
}

/// A file that the destructor removes.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& content) {
    path_ = (std::filesystem::temp_directory_path() / "lodeline-XXXXXX").string();
    const int descriptor = mkstemp(path_.data());
    if (descriptor < 0) return;
    FILE* file = fdopen(descriptor, "w");
    good_ = std::fwrite(content.data(), 1, content.size(), file) == content.size();
    good_ = std::fclose(file) == 0 && good_;
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool good() const { return good_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  bool good_ = false;
};

}  // namespace

std::string dataBlock(const std::string& name, const Curve& curve) {
  const std::size_t stride = curve.points.size() / kMaxPoints + 1;
  std::string text = fmt::format("${} << EOD\n", name);
  bool broken = false;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const Curve::Point& point = curve.points[i];
    broken = broken || (point.break_before && i > 0);
    if (i % stride != 0 && i + 1 != curve.points.size()) continue;
    const std::string value = point.value ? fmt::format(" {:.6g}", *point.value) : "";
    text += fmt::format("{}{:.6g} {:.6g}{}\n", broken ? "\n" : "", point.x, point.y, value);
    broken = false;
  }
  return text + "EOD\n";
}

std::string dataBlock(const std::string& name, const std::vector<std::vector<double>>& rows) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const auto& row : rows) text += fmt::format("{:.6g}\n", fmt::join(row, " "));
  return text + "EOD\n";
}

Result draw(const std::vector<Figure>& figures, const std::filesystem::path& folder) {
  const TemporaryFile script(scriptFor(figures, folder));
  if (!script.good()) return {Outcome::Failed, "no temporary file could be written"};
  FILE* pipe = popen(fmt::format("gnuplot '{}' 2>&1", script.path()).c_str(), "r");
  if (pipe == nullptr) return {Outcome::Failed, "no process could be started"};
  std::string message;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), static_cast<int>(buffer.size()), pipe) != nullptr)
    message += buffer.data();
  const int status = pclose(pipe);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {Outcome::Drawn, message};
  const bool missing = WIFEXITED(status) && WEXITSTATUS(status) == kShellCommandNotFound;
  return {missing ? Outcome::Missing : Outcome::Failed, message};
}

}  // namespace lodeline::gnuplot

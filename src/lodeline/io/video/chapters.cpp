#include "lodeline/io/video/chapters.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr int kMostChapters = 99;

bool areDigits(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// The parts of a name: prefix, chapter, and number of the recording.
struct ChapterName {
  std::string prefix;  ///< "GX" …; "GP" for the old form, whose first chapter is GOPR
  int chapter = 0;     ///< counts from 1
  std::string number;  ///< four digits
  std::string extension;

  std::string file(int of_chapter) const {
    const bool is_first_old = prefix == "GP" && of_chapter == 1;
    const int written = prefix == "GP" ? of_chapter - 1 : of_chapter;
    const std::string stem =
        is_first_old ? "GOPR" + number : fmt::format("{}{:02}{}", prefix, written, number);
    return stem + extension;
  }
};

std::optional<ChapterName> parse(const fs::path& file) {
  const std::string stem = file.stem().string();
  if (stem.size() != 8 || stem[0] != 'G' || !areDigits(stem.substr(4))) return std::nullopt;
  ChapterName name{stem.substr(0, 2), 1, stem.substr(4), file.extension().string()};
  if (stem.starts_with("GOPR")) {
    name.prefix = "GP";
    return name;
  }
  const bool is_known = std::string("HXSLP").find(stem[1]) != std::string::npos;
  if (!is_known || !areDigits(stem.substr(2, 2))) return std::nullopt;
  name.chapter = std::stoi(stem.substr(2, 2)) + (name.prefix == "GP" ? 1 : 0);
  return name.chapter > 0 ? std::optional(name) : std::nullopt;
}

}  // namespace

std::vector<fs::path> chaptersFrom(const fs::path& file, Diagnostics* diagnostics) {
  std::vector<fs::path> chapters = {file};
  const std::optional<ChapterName> name = parse(file);
  if (!name) return chapters;
  const auto path = [&](int chapter) { return file.parent_path() / name->file(chapter); };
  const auto isThere = [&](int chapter) {
    std::error_code ignored;
    return fs::is_regular_file(path(chapter), ignored);
  };
  int next = name->chapter + 1;
  while (next <= kMostChapters && isThere(next)) chapters.push_back(path(next++));
  for (int later = next + 1; later <= kMostChapters; ++later) {
    if (!isThere(later)) continue;
    diagnostics->report(
        Severity::Serious, "chapter_missing",
        fmt::format("{}: missing, but the later chapter {} is there; the recording is read up "
                    "to the missing one; copy it from the camera's card",
                    path(next).string(), path(later).filename().string()));
    break;
  }
  if (name->chapter > 1) {
    diagnostics->report(Severity::Notice, "chapter_left_out",
                        fmt::format("{}: is chapter {} of a recording; give {} to read it from its start",
                                    file.string(), name->chapter, path(1).filename().string()));
  }
  return chapters;
}

}  // namespace lodeline

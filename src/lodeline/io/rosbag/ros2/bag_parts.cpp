#include "lodeline/io/rosbag/ros2/bag_parts.h"

#include <fmt/core.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace lodeline {
namespace {

namespace fs = std::filesystem;

bool isBagFile(fs::path file) {
  if (file.extension() == ".zstd") file.replace_extension();
  return file.extension() == ".db3" || file.extension() == ".mcap";
}

/// Compares names with their numbers as numbers: bag_2 is before bag_10.
bool isBefore(const fs::path& left, const fs::path& right) {
  const std::string a = left.filename().string(), b = right.filename().string();
  const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!isDigit(a[i]) || !isDigit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto numberAt = [&](const std::string& text, size_t* at) {
      std::string digits;
      while (*at < text.size() && isDigit(text[*at])) digits += text[(*at)++];
      digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));
      return digits;
    };
    const std::string x = numberAt(a, &i), y = numberAt(b, &j);
    if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
  }
  return a.size() - i < b.size() - j;
}

/// The files in the folder, without a packed one beside its unpacked form.
std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (isBagFile(entry->path())) files.push_back(entry->path());
  }
  std::erase_if(files, [&](const fs::path& file) {
    if (file.extension() != ".zstd") return false;
    fs::path unpacked = file;
    return std::find(files.begin(), files.end(), unpacked.replace_extension()) != files.end();
  });
  std::sort(files.begin(), files.end(), isBefore);
  return files;
}

/// The file that metadata.yaml names; old versions state it with the folder, and it may have been unpacked or
/// packed since.
std::optional<fs::path> place(const fs::path& folder, const fs::path& named) {
  for (fs::path file : {folder / named.filename(), folder / named}) {
    std::error_code ignored;
    if (fs::exists(file, ignored)) return file;
    fs::path other = file;
    if (other.extension() == ".zstd") {
      other.replace_extension();
    } else {
      other += ".zstd";
    }
    if (fs::exists(other, ignored)) return other;
  }
  return std::nullopt;
}

BagParts fromMetadata(const fs::path& folder, Diagnostics* diagnostics) {
  const fs::path metadata = folder / "metadata.yaml";
  const YAML::Node information = YAML::LoadFile(metadata.string())["rosbag2_bagfile_information"];
  BagParts parts;
  for (const YAML::Node& name : information["relative_file_paths"]) {
    const std::optional<fs::path> file = place(folder, name.as<std::string>());
    if (file) {
      parts.files.push_back(*file);
    } else {
      diagnostics->report(Severity::Warning, "bag_part_missing",
                          fmt::format("{}: the file {} is missing; its messages are lost", metadata.string(),
                                      name.as<std::string>()));
    }
  }
  if (information["message_count"].IsDefined()) {
    parts.promised_messages = information["message_count"].as<uint64_t>();
  }
  for (const YAML::Node& topic : information["topics_with_message_count"]) {
    const YAML::Node stated = topic["topic_metadata"];
    parts.formats[stated["name"].as<std::string>()] = stated["serialization_format"].as<std::string>("cdr");
  }
  return parts;
}

}  // namespace

BagParts findBagParts(const fs::path& bag, Diagnostics* diagnostics) {
  std::error_code ignored;
  if (!fs::is_directory(bag, ignored)) return {{bag}};
  const std::vector<fs::path> present = filesIn(bag);
  BagParts parts;
  if (fs::exists(bag / "metadata.yaml", ignored)) {
    try {
      parts = fromMetadata(bag, diagnostics);
    } catch (const YAML::Exception& error) {
      diagnostics->report(Severity::Warning, "bag_metadata",
                          fmt::format("{}: is damaged ({}); all files beside it are taken",
                                      (bag / "metadata.yaml").string(), error.what()));
    }
  }
  if (parts.files.empty()) {
    if (present.empty()) throw InputError(bag.string() + ": holds no .db3 or .mcap file");
    parts.files = present;
  }
  for (const fs::path& file : present) {
    if (std::find(parts.files.begin(), parts.files.end(), file) != parts.files.end()) continue;
    diagnostics->report(
        Severity::Notice, "bag_part_unused",
        fmt::format("{}: is not part of the bag by its metadata.yaml, and is not read", file.string()));
  }
  return parts;
}

}  // namespace lodeline

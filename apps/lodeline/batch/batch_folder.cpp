#include "apps/lodeline/batch/batch_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "apps/lodeline/batch/item_claim.h"
#include "apps/lodeline/shared/program_file.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

const char* const kItemFile = "item.json";

std::string keyFromText(const std::string& text) { return fmt::format("{:016x}", hashOfBytes(text)); }

std::string programText() {
  return fmt::format("lodeline {}, build {:016x}\n", LODELINE_VERSION, programFingerprint());
}

/// Names and sizes of the files that describe a recording, or of the bag.
std::string sizesText(const fs::path& data) {
  std::vector<std::string> lines;
  std::error_code error;
  const auto add = [&](const fs::path& file) {
    const auto size = fs::file_size(file, error);
    if (!error) lines.push_back(fmt::format("{}: {} bytes\n", file.lexically_relative(data).string(), size));
  };
  if (!fs::is_directory(data)) add(data);
  for (const fs::path& folder : {data, data / "mav0"}) {
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (entry.is_regular_file(error)) add(entry.path());
      for (const char* file : {"data.csv", "sensor.yaml"}) add(entry.path() / file);
    }
  }
  std::sort(lines.begin(), lines.end());
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

/// Hash of the file that a word of a command names, also in KEY=FILE; empty where it names none.
std::string contentText(const std::string& word, const fs::path& folder) {
  constexpr std::uintmax_t kLargestHashedFile = 4u << 20;
  std::string text;
  for (const std::string& name : {word, word.substr(word.find('=') + 1)}) {
    std::error_code error;
    const fs::path file = folder / name;
    if (name.empty() || !fs::is_regular_file(file, error)) continue;
    const auto size = fs::file_size(file, error);
    if (error) continue;
    text += size <= kLargestHashedFile ? keyFromText(readFileBytes(file)) : fmt::format("{} bytes", size);
    text += "\n";
  }
  return text;
}

}  // namespace

BatchFolder::BatchFolder(const fs::path& folder) : folder_(fs::absolute(folder).lexically_normal()) {}

ItemState BatchFolder::state(const BatchItem& item, const std::string& key) const {
  const auto has = [&](const fs::path& folder) {
    const auto json = readItemFile(folder);
    return json.is_object() && json.value("key", "") == key;
  };
  if (has(result(item))) return ItemState::Done;
  return has(failure(item)) ? ItemState::Failed : ItemState::Open;
}

bool BatchFolder::isSimulated(const BatchItem& item) const {
  const auto json = readItemFile(simulated(item));
  return json.is_object() && json.value("key", "") == keyOfSimulation(item);
}

std::string keyOfItem(const BatchItem& item, const BatchList& list) {
  std::string text = programText();
  if (item.simulate.empty()) {
    text += item.data + "\n" + sizesText(list.folder / item.data);
  } else {
    text += keyOfSimulation(item) + "\n";
  }
  for (const std::string& word : item.arguments) text += word + "\n" + contentText(word, list.folder);
  text += fmt::format("truth {} {}\n", item.truth, toString(list.alignment));
  if (list.tolerance_s) text += fmt::format("tolerance {}\n", *list.tolerance_s);
  if (!item.truth.empty()) text += sizesText(list.folder / item.truth);
  return keyFromText(text);
}

std::string keyOfSimulation(const BatchItem& item) {
  std::string text = programText() + "simulate\n";
  for (const std::string& word : item.simulate) text += word + "\n";
  return keyFromText(text);
}

nlohmann::ordered_json readItemFile(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / kItemFile, error)) return nullptr;
  try {
    return nlohmann::ordered_json::parse(readFileBytes(folder / kItemFile));
  } catch (const std::exception&) {
    return nullptr;  // damaged, or replaced at this moment
  }
}

void writeItemFile(const fs::path& folder, const nlohmann::ordered_json& json) {
  writeOutput(folder / kItemFile, jsonText(json) + "\n");
}

void replaceFile(const fs::path& file, const std::string& text) {
  const fs::path temporary = file.string() + "." + processLabel();
  writeOutput(temporary, text);
  fs::rename(temporary, file);
}

void publishFolder(const fs::path& from, const fs::path& to) {
  createOutputFolder(to.parent_path());
  std::error_code error;
  if (fs::exists(to, error)) {
    const fs::path old = from.parent_path() / "replaced";
    fs::rename(to, old);
    fs::remove_all(old, error);
  }
  fs::rename(from, to);
}

}  // namespace lodeline

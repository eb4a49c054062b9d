#include "apps/lodeline/benchmark/prepared_sequence.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apps/lodeline/batch/batch_folder.h"
#include "apps/lodeline/batch/item_claim.h"
#include "apps/lodeline/benchmark/sequence_truth.h"
#include "apps/lodeline/shared/program_file.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Work on one sequence in one layout.
class SequencePreparation {
 public:
  SequencePreparation(const SetSequence& sequence, const SetLayout& layout, const SetFolder& files,
                      fs::path folder)
      : sequence_(sequence), layout_(layout), files_(files), folder_(std::move(folder)) {
    prepared_.sequence = &sequence;
  }

  /// Whether the recording, or a part of it, is there.
  bool isFound() const {
    const auto exists = [&](const std::string& pattern) { return find(pattern).has_value(); };
    return std::any_of(layout_.data.begin(), layout_.data.end(), exists) ||
           std::any_of(layout_.links.begin(), layout_.links.end(),
                       [&](const auto& link) { return exists(link.second); });
  }

  PreparedSequence make() {
    try {
      findData();
      prepareCalibration();
      prepareData();
      prepareTruth();
    } catch (const InputError& error) {
      prepared_.problem = error.what();
    } catch (const UsageError& error) {
      prepared_.problem = error.what();
    }
    return prepared_;
  }

 private:
  std::optional<fs::path> find(const std::string& pattern) const {
    return files_.find(pattern, sequence_.words);
  }

  bool isBagThere() const { return !data_.empty() && isBag(data_); }

  [[noreturn]] void refuseMissing(const std::string& what, const std::vector<std::string>& patterns) const {
    std::vector<std::string> names;
    for (const std::string& pattern : patterns) names.push_back(withWords(pattern, sequence_.words));
    throw InputError(fmt::format("{} is missing: {}", what, fmt::join(names, " or ")));
  }

  void findData() {
    for (const std::string& pattern : layout_.data) {
      const auto found = find(pattern);
      if (!found) continue;
      data_ = *found;
      return;
    }
  }

  /// Takes the calibration of the set, unless there is another one beside the bag.
  void prepareCalibration() {
    std::error_code ignored;
    if (isBagThere() && fs::exists(rigFileBeside(data_), ignored)) return;
    for (const std::string& pattern : layout_.rig) {
      const auto file = find(pattern);
      if (!file) refuseMissing("calibration", {pattern});
      bag_.rig_files.push_back(file->string());
    }
    if (!layout_.rig_text.empty()) {
      const fs::path file = folder_ / "rig.yaml";
      createOutputFolder(folder_);
      std::error_code ignored;
      const bool is_there = fs::is_regular_file(file, ignored) && readFileBytes(file) == layout_.rig_text;
      if (!is_there) replaceFile(file, layout_.rig_text);
      bag_.rig_files.push_back(file.string());
    }
    for (const std::string& file : bag_.rig_files) addArguments({"--rig", file});
  }

  void prepareData() {
    if (!layout_.links.empty()) return prepareLinks();
    if (isBagThere()) {
      for (const auto& [sensor, topic] : layout_.topics) {
        bag_.topics.push_back(fmt::format("{}={}", sensor, topic));
        addArguments({"--topic", bag_.topics.back()});
      }
    }
    prepared_.data = data_.string();
  }

  /// Makes a folder in the EuRoC ASL layout of links to the files of the set.
  void prepareLinks() {
    std::map<std::string, fs::path> targets;
    for (const auto& [name, pattern] : layout_.links) {
      const auto target = find(pattern);
      if (!target) refuseMissing(name, {pattern});
      targets[name] = *target;
    }
    for (const auto& [name, target] : targets) {
      const fs::path link = folder_ / name;
      createOutputFolder(link.parent_path());
      const fs::path temporary = link.string() + "." + processLabel();
      std::error_code error;
      fs::remove(temporary, error);
      fs::create_symlink(target, temporary, error);
      if (!error) fs::rename(temporary, link, error);
      if (error) throw InputError(fmt::format("{}: cannot be linked ({})", link.string(), error.message()));
    }
    data_ = folder_;
    prepared_.data = data_.string();
  }

  void prepareTruth() {
    std::vector<std::string> missing;
    for (const SetTruth& truth : layout_.truth) {
      if (!truth.topic.empty()) {
        missing.push_back(fmt::format("topic {}", truth.topic));
        if (isBagThere() && hasTopic(data_, truth.topic)) return writeTruth(truth, {});
      } else {
        missing.push_back(truth.file);
        if (const auto file = find(truth.file)) return writeTruth(truth, *file);
      }
    }
    refuseMissing("truth", missing);
  }

  /// Text of all that the truth depends on. Reading it from a large bag takes long, so it is kept.
  std::string originOfTruth(const SetTruth& truth, const fs::path& file) const {
    std::vector<fs::path> sources(bag_.rig_files.begin(), bag_.rig_files.end());
    sources.push_back(file.empty() ? data_ : file);
    if (!truth.frame_numbers.empty()) sources.push_back(requireFile(truth.frame_numbers));
    if (isBagThere()) sources.push_back(rigFileBeside(data_));
    std::string text = fmt::format("program {:016x}\n", programFingerprint());
    for (const fs::path& source : sources) {
      text += fmt::format("{} of {:.6f}\n", source.string(), changeTime_s(source));
    }
    return text;
  }

  void writeTruth(const SetTruth& truth, const fs::path& file) {
    const fs::path origin_file = folder_ / "truth_origin.txt";
    const std::string origin = originOfTruth(truth, file);
    std::error_code ignored;
    if (!fs::is_regular_file(origin_file, ignored) || readFileBytes(origin_file) != origin) {
      makeTruth(truth, file);
      replaceFile(origin_file, origin);
    }
    prepared_.truth = (folder_ / "truth.tum").string();
  }

  void makeTruth(const SetTruth& truth, const fs::path& file) {
    Diagnostics diagnostics;
    Trajectory poses = !truth.topic.empty() ? readBagPoses(data_, truth.topic, &diagnostics)
                       : truth.frame_numbers.empty()
                           ? readTrajectory(file, {}, diagnostics)
                           : readNumberedPoses(file, requireFile(truth.frame_numbers), &diagnostics);
    if (truth.is_of_camera) poses = bodyFromCamera(std::move(poses), data_, bag_, &diagnostics);
    createOutputFolder(folder_);
    const fs::path temporary = folder_ / ("truth.tum." + processLabel());
    writeTum(poses, temporary);
    fs::rename(temporary, folder_ / "truth.tum");
  }

  fs::path requireFile(const std::string& pattern) const {
    const auto file = find(pattern);
    if (!file) refuseMissing("list of images", {pattern});
    return *file;
  }

  void addArguments(const std::vector<std::string>& words) {
    prepared_.arguments.insert(prepared_.arguments.end(), words.begin(), words.end());
  }

  const SetSequence& sequence_;
  const SetLayout& layout_;
  const SetFolder& files_;
  fs::path folder_;
  fs::path data_;
  BagArguments bag_;
  PreparedSequence prepared_;
};

}  // namespace

std::optional<PreparedSequence> prepareSequence(const BenchmarkSet& set, const SetSequence& sequence,
                                                const SetFolder& files, const fs::path& folder) {
  for (const SetLayout& layout : set.layouts) {
    SequencePreparation preparation(sequence, layout, files, folder);
    if (preparation.isFound()) return preparation.make();
  }
  return std::nullopt;
}

}  // namespace lodeline

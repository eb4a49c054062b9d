#include "apps/lodeline/compare/compared_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/lodeline/compare/azimuth_method.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

const char* const kAzimuth = "azimuth";

/// Setting magnetometer.model of the runs of a method.
std::string modelOf(const std::string& method) { return method == kAzimuth ? "off" : method; }

/// RECORDING.METHOD.SEED, without blanks.
std::string runName(const ComparisonInput& input, const std::string& method, const ComparisonSeed& seed) {
  std::string name = fmt::format("{}.{}.{}", input.name, method, seed.name);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// Words of `lodeline run` for the options of a comparison.
std::vector<std::string> runWords(const RunRequest& request) {
  std::vector<std::string> words = {"--no-report"};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) words.insert(words.end(), {option, value});
  };
  add("--config", request.config);
  for (const std::string& setting : request.overrides) add("--set", setting);
  add("--mag-calibration", request.magnetometer_calibration);
  add("--site", request.site);
  add("--date", request.date);
  for (const std::string& file : request.bag.rig_files) add("--rig", file);
  for (const std::string& topic : request.bag.topics) add("--topic", topic);
  if (request.bag.use_received_times) words.emplace_back("--received-times");
  return words;
}

BatchItem itemOf(const ComparisonInput& input, const std::string& model, const ComparisonSeed& seed) {
  BatchItem item;
  item.name = runName(input, model, seed);
  item.recording = input.name;
  item.variant = model;
  item.data = fs::weakly_canonical(seed.data).string();
  item.arguments = runWords(input.run);
  item.arguments.insert(item.arguments.end(), {"--magnetometer", model, "--set",
                                               fmt::format("front_end.seed={}", seed.feature_seed)});
  return item;
}

/// Heading basis of a run from its summary. Methods are compared with each other and with a corrected azimuth
/// here, so magnetic north counts as north; its declination is an error of all of them.
HeadingBasis basisOf(const nlohmann::json& summary) {
  const std::string reference = summary.value("/heading/reference"_json_pointer, std::string());
  return reference.find("north") != std::string::npos ? HeadingBasis::North : HeadingBasis::Start;
}

Trajectory readPoses(const fs::path& folder) {
  Diagnostics diagnostics;
  return readTrajectory(folder / "trajectory.tum", {}, diagnostics);
}

void judge(const Trajectory& trajectory, HeadingBasis basis, const ComparisonInput& input, ComparedRun* run) {
  EvaluationOptions options;
  options.association.method = AssociationMethod::Interpolate;
  // A ground truth at a few hertz suffices for a swimmer; the tolerance is below half an image period.
  options.association.tolerance_s = 0.02;
  options.expected_stamps = input.expected_stamps;
  Diagnostics diagnostics;
  run->errors = computeRunErrors(trajectory, input.truth, basis, options, diagnostics);
  run->completion = run->errors->completion.share;
}

}  // namespace

bool isComparedMethod(const std::string& name) {
  return name == "off" || name == "paper" || name == "absolute" || name == kAzimuth;
}

BatchList comparedRuns(const std::vector<ComparisonInput>& inputs, const std::vector<std::string>& methods) {
  std::vector<std::string> models;
  for (const std::string& method : methods) {
    const std::string model = modelOf(method);
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
  }
  BatchList list;
  list.folder = fs::current_path();
  for (const ComparisonInput& input : inputs) {
    for (const std::string& model : models) {
      for (const ComparisonSeed& seed : input.seeds) list.items.push_back(itemOf(input, model, seed));
    }
  }
  return list;
}

ComparedRun judgeComparedRun(const ComparisonInput& input, const ComparisonSeed& seed,
                             const std::string& method, const std::vector<BatchRow>& rows,
                             const BatchFolder& folder) {
  const std::string name = runName(input, modelOf(method), seed);
  const auto row =
      std::find_if(rows.begin(), rows.end(), [&](const BatchRow& r) { return r.item->name == name; });
  ComparedRun run;
  run.seed = seed.name;
  run.failure = row->reason;
  // A run that ends with an error may have a summary and a trajectory.
  const fs::path made = row->status == "failed" ? folder.failure(*row->item) : folder.result(*row->item);
  if (!fs::exists(made / "run.json")) return run;
  try {
    const auto summary = nlohmann::json::parse(readFileBytes(made / "run.json"));
    run.core_ms_per_frame = summary.value("/core_ms_per_frame/total"_json_pointer, 0.0);
    if (summary.value("frames_with_pose", 0) == 0) {
      run.failure = fmt::format("no pose after {} frames; still waiting for {}", summary.value("frames", 0),
                                summary.value("waiting_for", std::string("images")));
      return run;
    }
    Trajectory trajectory = readPoses(made);
    HeadingBasis basis = basisOf(summary);
    if (method == kAzimuth) {
      RunRequest request = input.run;
      request.data = seed.data.string();
      request.magnetometer = modelOf(method);
      trajectory =
          makeAzimuthRun(request, trajectory, folder.path() / "results" / runName(input, method, seed));
      basis = HeadingBasis::North;
    }
    judge(trajectory, basis, input, &run);
    run.failure.clear();
  } catch (const InputError& error) {
    run.failure = error.what();
  } catch (const EstimationError& error) {
    run.failure = error.what();
  }
  return run;
}

}  // namespace lodeline

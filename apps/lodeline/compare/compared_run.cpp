#include "apps/lodeline/compare/compared_run.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/lodeline/compare/azimuth_method.h"
#include "apps/lodeline/shared/program_file.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

const char* const kDoneFile = "made_from.txt";

/// Text of everything that influences the result, to detect whether a run exists already.
std::string identity(const RunRequest& request) {
  RunSettings options;
  Settings settings;
  applyRequest(request, &settings, &options);
  std::ostringstream text;
  text << fmt::format("lodeline {}, build {:016x}\n", LODELINE_VERSION, programFingerprint())
       << fs::weakly_canonical(request.data).string() << "\n";
  const fs::path mav0 = fs::is_directory(fs::path(request.data) / "mav0") ? fs::path(request.data) / "mav0"
                                                                          : fs::path(request.data);
  for (const char* sensor : {"cam0", "cam1", "imu0", "mag0", "pressure0"}) {
    for (const char* file : {"data.csv", "sensor.yaml"}) {
      const fs::path path = mav0 / sensor / file;
      std::error_code missing;
      const auto size = fs::file_size(path, missing);
      if (!missing) text << sensor << "/" << file << ": " << size << " bytes\n";
    }
  }
  settings.write(text);
  if (!options.magnetometer_calibration.empty()) text << readFileBytes(options.magnetometer_calibration);
  for (const std::string& file : request.bag.rig_files) text << readFileBytes(file);
  return text.str();
}

nlohmann::json readSummary(const fs::path& folder) {
  return nlohmann::json::parse(readFileBytes(folder / "run.json"));
}

/// Whether the folder contains the complete run; another, incomplete run may have replaced it.
bool isDone(const fs::path& folder, const std::string& made_from) {
  if (!fs::exists(folder / kDoneFile) || readFileBytes(folder / kDoneFile) != made_from) return false;
  if (!fs::exists(folder / "run.json")) return false;
  constexpr bool kThrow = false;  // a truncated file is not that of a complete run
  const auto summary = nlohmann::json::parse(readFileBytes(folder / "run.json"), nullptr, kThrow);
  return summary.is_object() && !summary.value("interrupted", true);
}

/// Returns false where the user stopped the run.
bool estimate(const RunRequest& request) {
  const fs::path folder = request.output;
  const std::string made_from = identity(request);
  if (isDone(folder, made_from)) return true;
  std::error_code ignored;
  fs::remove(folder / kDoneFile, ignored);
  Diagnostics diagnostics;
  if (runRecording(request, &diagnostics).interrupted) return false;
  writeOutput(folder / kDoneFile, made_from);
  return true;
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

void judge(const Trajectory& trajectory, const Trajectory& truth, HeadingBasis basis,
           const ComparisonInput& input, ComparedRun* run) {
  EvaluationOptions options;
  options.association.method = AssociationMethod::Interpolate;
  // A ground truth at a few hertz suffices for a swimmer; the tolerance is below half an image period.
  options.association.tolerance_s = 0.02;
  options.expected_stamps = input.expected_stamps;
  Diagnostics diagnostics;
  run->errors = computeRunErrors(trajectory, truth, basis, options, diagnostics);
  run->completion = run->errors->completion.share;
}

}  // namespace

bool isComparedMethod(const std::string& name) {
  return name == "off" || name == "paper" || name == "absolute" || name == "azimuth";
}

std::optional<ComparedRun> makeComparedRun(const ComparisonInput& input, const ComparisonSeed& seed,
                                           const std::string& method, const fs::path& input_folder,
                                           const Trajectory& truth) {
  const bool by_azimuth = method == "azimuth";
  RunRequest request = input.run;
  request.data = seed.data.string();
  request.magnetometer = by_azimuth ? "off" : method;
  request.overwrite = true;
  request.overrides.push_back(fmt::format("front_end.seed={}", seed.feature_seed));
  const auto folderOf = [&](const std::string& name) {
    std::string folder = name + "_" + seed.name;
    for (char& c : folder) c = c == ' ' ? '_' : c;
    return input_folder / folder;
  };
  request.output = folderOf(request.magnetometer).string();
  ComparedRun run;
  run.seed = seed.name;
  try {
    if (!estimate(request)) return std::nullopt;
    const nlohmann::json summary = readSummary(request.output);
    run.core_ms_per_frame = summary.value("/core_ms_per_frame/total"_json_pointer, 0.0);
    if (summary.value("frames_with_pose", 0) == 0) {
      run.failure = fmt::format("no pose after {} frames; still waiting for {}", summary.value("frames", 0),
                                summary.value("waiting_for", std::string("images")));
      return run;
    }
    Trajectory trajectory = readPoses(request.output);
    if (by_azimuth) trajectory = makeAzimuthRun(request, trajectory, folderOf(method));
    judge(trajectory, truth, by_azimuth ? HeadingBasis::North : basisOf(summary), input, &run);
  } catch (const InputError& error) {
    run.failure = error.what();
  } catch (const EstimationError& error) {
    run.failure = error.what();
  }
  return run;
}

}  // namespace lodeline

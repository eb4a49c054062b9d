#include "apps/lodeline/compare/comparison_input.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "apps/lodeline/simulate/simulate_recording.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/convert.h"
#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/pipeline/calibration/available_images.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/file_kind.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

std::string label(const std::string& name, const ScenarioChanges& changes) {
  std::string text = name + "_" + changes.realism;
  if (changes.seed && *changes.seed != 1) text += fmt::format("_seed{}", *changes.seed);
  if (changes.cave_seed) text += fmt::format("_cave{}", *changes.cave_seed);
  if (changes.dive_seed) text += fmt::format("_dive{}", *changes.dive_seed);
  if (changes.entrance) text += fmt::format("_entrance{}", *changes.entrance);
  return text;
}

fs::path recordingsFolder(const ComparisonRequest& request) {
  return request.recordings.empty() ? request.output / "recordings" : request.recordings;
}

/// Calibrates the dive's rig, whose errors depend only on seed and grade, from rotations by hand before the
/// dive.
fs::path calibrateRig(const Scenario& dive, const std::string& name, const ComparisonRequest& request) {
  ScenarioChanges changes;
  changes.seed = dive.seed;
  changes.realism = request.changes.realism;
  changes.effects = request.changes.effects;
  changes.imu_rate_hz = request.changes.imu_rate_hz;
  changes.magnetometer_rate_hz = request.changes.magnetometer_rate_hz;
  changes.imu_grade = dive.imu_grade;
  const Scenario turning = makeScenario("figure_eight", changes);
  const fs::path folder = recordingsFolder(request) / (label("figure_eight", changes) + "_" + dive.imu_grade);
  if (!holdsRecording(turning, folder)) simulateRecording(turning, folder, {.quiet = true});
  Diagnostics diagnostics;
  const MagnetometerRecord record = readMagnetometerRecord(folder, {}, &diagnostics);
  CalibrationOptions options;
  options.site_field_ENU = scenarioField(turning);
  const fs::path file = request.output / name / "mag.yaml";
  createOutputFolder(file.parent_path());
  writeCalibrationFile(calibrateMagnetometer(record, options, &diagnostics).fit, file);
  return file;
}

bool isRendered(const Scenario& scenario, const fs::path& folder) {
  if (!holdsRecording(scenario, folder)) return false;
  try {
    return findAvailableImages(folder, {}).complete;
  } catch (const InputError&) {
    return false;  // interrupted before the first image
  }
}

/// Returns false where the user stopped the rendering.
bool render(const Scenario& scenario, const fs::path& folder, const ComparisonRequest& request) {
  if (isRendered(scenario, folder)) return true;
  if (request.render) {
    return simulateRecording(scenario, folder, {.threads = request.threads, .quiet = request.run.quiet})
        .complete;
  }
  if (!holdsRecording(scenario, folder)) {
    throw InputError(fmt::format(
        "{}: holds no recording of this scenario; leave out --no-rendering, or name the folder that has it "
        "with --recordings",
        folder.string()));
  }
  return true;
}

/// Records a noise seed in another folder. Existing recordings are not changed, because another comparison
/// may be reading them.
void recordNoiseAside(const Scenario& noisy, const fs::path& original, const fs::path& folder) {
  if (holdsRecording(noisy, folder)) return;
  const fs::path unfinished = folder.string() + "_unfinished";
  fs::remove_all(unfinished);
  recordOtherNoise(noisy, original, unfinished);
  fs::remove_all(folder);
  fs::rename(unfinished, folder);
}

bool prepareScenario(const std::string& name, const ComparisonRequest& request, ComparisonInput* prepared) {
  const Scenario scenario = makeScenario(name, request.changes);
  if (!scenario.images)
    throw UsageError(name + ": is simulated without images; there is nothing to compare on");
  prepared->name = label(name, request.changes);
  prepared->origin = fmt::format("simulated, {}, seed {}", request.changes.realism, scenario.seed);
  const fs::path folder = recordingsFolder(request) / prepared->name;
  if (!render(scenario, folder, request)) return false;
  for (int run = 0; run < request.runs; ++run) {
    Scenario noisy = scenario;
    noisy.noise_seed = scenario.seed + static_cast<uint64_t>(run);
    ComparisonSeed seed{fmt::format("noise {}", *noisy.noise_seed), folder};
    if (run > 0) {
      seed.data = recordingsFolder(request) / fmt::format("{}_noise{}", prepared->name, *noisy.noise_seed);
      recordNoiseAside(noisy, folder, seed.data);
    }
    prepared->seeds.push_back(seed);
  }
  RunRequest& run = prepared->run;
  if (run.site.empty()) {
    run.site = fmt::format("{},{},{}", scenario.site.latitude_deg, scenario.site.longitude_deg,
                           scenario.site.height_m);
    run.date = scenario.date;
  }
  if (run.magnetometer_calibration.empty()) {
    run.magnetometer_calibration = calibrateRig(scenario, prepared->name, request).string();
  }
  return true;
}

void prepareFolder(const fs::path& folder, const ComparisonRequest& request, ComparisonInput* prepared) {
  const fs::path whole = fs::weakly_canonical(folder);
  const fs::path named = whole.filename() == "mav0" ? whole.parent_path() : whole;
  prepared->name = named.filename().string();
  for (char& c : prepared->name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
  }
  prepared->origin = "recording";
  for (int run = 1; run <= request.runs; ++run) {
    prepared->seeds.push_back({fmt::format("features {}", run), folder, run});
  }
}

/// Converts a bag or a film to a folder, because these have no list of images for the comparison.
fs::path convertedRecording(const fs::path& bag, const ComparisonRequest& request) {
  const fs::path folder =
      recordingsFolder(request) / (bag.stem().string() + (isBag(bag) ? "_from_bag" : "_from_film"));
  if (fs::exists(folder) && fs::last_write_time(folder) >= fs::last_write_time(bag)) return folder;
  const fs::path unfinished = folder.string() + "_unfinished";
  fs::remove_all(unfinished);
  Diagnostics diagnostics;  // the runs report faults of the data as well
  ConvertOptions options;
  options.rig_files.assign(request.run.bag.rig_files.begin(), request.run.bag.rig_files.end());
  options.topics = topicsOf(request.run.bag);
  Progress progress("conversion", request.run.quiet);
  options.progress = progress.function();
  if (isBag(bag)) {
    convertBagToFolder(bag, unfinished, options, &diagnostics);
  } else {
    const std::unique_ptr<VideoSource> film = openVideo(bag, EurocOptions(), request.run.bag, &diagnostics);
    convertToFolder(film.get(), film->rigFile(), unfinished, options, &diagnostics);
  }
  fs::remove_all(folder);
  fs::rename(unfinished, folder);
  fs::last_write_time(folder, fs::file_time_type::clock::now());
  return folder;
}

/// The ground truth of the recording.
Trajectory readTruth(const fs::path& data) {
  Diagnostics diagnostics;
  try {
    return readTrajectory(data, {}, diagnostics);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: methods are compared by ground truth, which it lacks ({})",
                                 data.string(), error.what()));
  }
}

/// Limits a recording to the part with images, and describes that part.
void limitToImages(ComparisonInput* prepared) {
  RunSettings options;
  Settings settings;
  applyRequest(prepared->run, &settings, &options);
  const fs::path& data = prepared->seeds.front().data;
  AvailableImages images = findAvailableImages(data, options.source);
  const double skip_s = options.synchronizer.skip_s;
  double duration_s = options.synchronizer.duration_s;
  const double available_s = images.available_s() - skip_s;
  const bool cut = !images.complete && (duration_s == 0.0 || duration_s > available_s);
  if (cut) {
    duration_s = available_s;
    prepared->run.overrides.push_back(fmt::format("source.duration_s={}", duration_s));
  }
  const Time start = images.stamps.front();
  std::erase_if(images.stamps, [&](Time stamp) {
    const double since_start_s = (stamp - start).seconds();
    return since_start_s < skip_s || (duration_s > 0.0 && since_start_s > skip_s + duration_s);
  });
  if (images.stamps.size() < 2) {
    throw InputError(fmt::format("{}: no images are left of {:.1f} s that are there", data.string(),
                                 images.available_s()));
  }
  prepared->expected_stamps = images.stamps;
  const double used_s = images.available_s();
  prepared->extent = used_s >= images.whole_s - 1e-6
                         ? fmt::format("in full, {:.0f} s", used_s)
                         : fmt::format("an excerpt, {:.0f} s from second {:.0f} on, of {:.0f} s{}", used_s,
                                       skip_s, images.whole_s, cut ? " (the rest has no images)" : "");
}

}  // namespace

bool prepareComparison(const std::string& input, const ComparisonRequest& request,
                       ComparisonInput* prepared) {
  prepared->run = request.run;
  const auto& all = scenarios();
  const bool is_scenario =
      std::any_of(all.begin(), all.end(), [&](const Scenario& s) { return s.name == input; });
  if (is_scenario) {
    if (!prepareScenario(input, request, prepared)) return false;
  } else if (fs::is_directory(input) && !isBag(input) && !isVideo(input)) {
    prepareFolder(input, request, prepared);
  } else if (isBag(input) || isVideo(input)) {
    prepareFolder(convertedRecording(input, request), request, prepared);
    prepared->run.bag = {};
  } else {
    std::string names;
    for (const Scenario& s : all) names += (names.empty() ? "" : ", ") + s.name;
    const RecognizedFile recognized = recognizeFile(input);
    if (recognized.kind != FileKind::Missing)
      refuseFile(recognized, "give a folder with mav0, a ROS bag or a film with telemetry");
    throw UsageError(
        fmt::format("{}: neither a folder, a bag nor a scenario; scenarios are {}", input, names));
  }
  prepared->truth = readTruth(prepared->seeds.front().data);
  limitToImages(prepared);
  return true;
}

}  // namespace lodeline

#include "lodeline/simulation.h"

#include <fmt/format.h>

#include <sstream>

#include "lodeline/diagnostics.h"
#include "simulation/dive/dive_world.h"
#include "simulation/recording/image_recording.h"
#include "simulation/recording/recording_files.h"
#include "simulation/recording/sensor_recording.h"
#include "simulation/recording/truth_recording.h"

namespace lodeline {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// Whether the folder has an earlier, possibly unfinished, recording of the same scenario.
bool claim(const std::filesystem::path& folder, const std::string& identity) {
  const std::filesystem::path file = folder / "truth" / "scenario.yaml";
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) {
    if (contents(file) == identity) return true;
    throw InputError(
        fmt::format("{}: holds another recording (its truth/scenario.yaml differs); choose another folder "
                    "with -o or delete this one",
                    folder.string()));
  }
  if (std::filesystem::exists(folder, ignored) &&
      !(std::filesystem::is_directory(folder, ignored) && std::filesystem::is_empty(folder, ignored))) {
    throw InputError(fmt::format(
        "{}: exists and is no recording of the simulator; choose another folder with -o", folder.string()));
  }
  RecordingFile scenario(file);
  scenario.write(identity);
  scenario.close();
  return false;
}

// A relative link, which stays valid when both folders are moved together.
void linkTo(const std::filesystem::path& target, const std::filesystem::path& link) {
  std::error_code error;
  if (std::filesystem::exists(link, error)) return;
  std::filesystem::remove(link, error);
  const std::filesystem::path from = std::filesystem::canonical(link.parent_path(), error);
  const std::filesystem::path to = std::filesystem::canonical(target, error);
  if (!error) std::filesystem::create_symlink(to.lexically_relative(from), link, error);
  if (error) {
    throw InputError(
        fmt::format("{}: cannot be made a link to {} ({})", link.string(), target.string(), error.message()));
  }
}

}  // namespace

RecordingSummary recordScenario(const Scenario& scenario, const std::filesystem::path& folder,
                                const ImageRecordingOptions& options,
                                const std::function<void(const char*)>& stage) {
  const auto tell = [&](const char* what) {
    if (stage) stage(what);
  };
  // Created before the folder is written, so that an impossible scenario leaves no files.
  const Dive dive = makeDive(scenario);
  RecordingSummary summary;
  summary.resumed = claim(folder, describe(scenario));
  summary.duration_s = dive.motion.duration_s();
  summary.path_length_m = pathLength(dive.motion, 0.0, dive.motion.duration_s());

  tell("building the world");
  const std::shared_ptr<const RenderWorld> world = buildWorld(dive);
  RangeFunction range;
  if (world) {
    range = [&world](const Vec3& origin, const Vec3& direction) {
      return world->scene.range(origin, direction);
    };
  }
  const RenderSettings settings = renderSettings(dive);
  const std::vector<ScheduledImage> images =
      scenario.images && world ? scheduleImages(dive) : std::vector<ScheduledImage>{};

  tell("writing sensor readings and truth");
  recordSensors(dive, range, folder);
  if (dive.board) {
    RecordingFile board(folder / "board.yaml");
    board.write(boardText(dive.board->board));
    board.close();
  }
  recordTruth(dive, settings, images, range, folder);
  if (images.empty()) return summary;

  tell("rendering images");
  recordImageLists(dive, images, folder);
  const ImageRenderer renderer(world, dive.errors.truth.rig, settings);
  summary.images = recordImages(renderer, dive, images, folder, options);
  summary.complete = summary.images.done == summary.images.total;
  return summary;
}

bool holdsRecording(const Scenario& scenario, const std::filesystem::path& folder) {
  return contents(folder / "truth" / "scenario.yaml") == describe(scenario);
}

void recordOtherNoise(const Scenario& scenario, const std::filesystem::path& original,
                      const std::filesystem::path& folder) {
  Scenario with_original_noise = scenario;
  with_original_noise.noise_seed.reset();
  if (!holdsRecording(with_original_noise, original)) {
    throw InputError(
        fmt::format("{}: is no recording of this scenario to take images from", original.string()));
  }
  const Dive dive = makeDive(scenario);
  claim(folder, describe(scenario));
  recordSensors(dive, {}, folder);
  for (const char* name : {"sonar0", "altimeter0", "dvl0"}) {
    if (std::filesystem::exists(original / "mav0" / name))
      linkTo(original / "mav0" / name, folder / "mav0" / name);
  }
  for (int camera = 0; scenario.images && camera < scenario.rig.cameras; ++camera) {
    const std::string name = fmt::format("cam{}", camera);
    for (const char* part : {"data.csv", "data"}) {
      linkTo(original / "mav0" / name / part, folder / "mav0" / name / part);
    }
  }
}

}  // namespace lodeline

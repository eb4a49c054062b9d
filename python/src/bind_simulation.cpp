#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <future>
#include <mutex>

#include "lodeline/simulation.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

namespace fs = std::filesystem;

/// Simulates on another thread, so that this one can see Ctrl-C and call `progress` now and then.
RecordingSummary simulate(const Scenario& scenario, const fs::path& folder, int threads,
                          const py::object& progress) {
  std::atomic<bool> is_stopped = false;
  std::mutex mutex;
  ImageProgress newest;
  ImageRecordingOptions options;
  options.threads = threads;
  options.stop = [&] { return is_stopped.load(); };
  options.progress = [&](const ImageProgress& p) {
    const std::lock_guard lock(mutex);
    newest = p;
  };
  std::future<RecordingSummary> work =
      std::async(std::launch::async, [&] { return recordScenario(scenario, folder, options); });
  std::exception_ptr raised;
  const auto isDone = [&] {
    return withoutGil(
        [&] { return work.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready; });
  };
  for (bool is_done = false; !is_done;) {
    is_done = isDone();
    if (is_stopped) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      const ImageProgress shown = [&] {
        const std::lock_guard lock(mutex);
        return newest;
      }();
      if (!progress.is_none() && shown.total > 0) is_stopped = endsWork(progress(shown.done, shown.total));
    } catch (...) {
      raised = std::current_exception();
      is_stopped = true;
    }
  }
  const RecordingSummary summary = work.get();
  if (raised) std::rethrow_exception(raised);
  return summary;
}

ScenarioChanges changesFrom(const py::kwargs& given) {
  ScenarioChanges changes;
  py::dict rest(given);
  const auto take = [&](const char* key, auto* value) {
    if (!rest.contains(key)) return;
    using Value = std::decay_t<decltype(*value)>;
    *value = py::object(rest[key]).cast<Value>();
    rest.attr("pop")(key);
  };
  take("seconds", &changes.seconds);
  take("metres", &changes.metres);
  take("seed", &changes.seed);
  take("cave_seed", &changes.cave_seed);
  take("dive_seed", &changes.dive_seed);
  take("cave_metres", &changes.cave_metres);
  take("laps", &changes.laps);
  take("entrance", &changes.entrance);
  take("tags", &changes.tags);
  take("width_px", &changes.width_px);
  take("height_px", &changes.height_px);
  take("cameras", &changes.cameras);
  take("camera_rate_hz", &changes.camera_rate_hz);
  take("imu_rate_hz", &changes.imu_rate_hz);
  take("magnetometer_rate_hz", &changes.magnetometer_rate_hz);
  take("imu", &changes.imu_grade);
  take("camera_model", &changes.camera_model);
  take("readout_ms", &changes.readout_ms);
  take("realism", &changes.realism);
  take("starts_moving", &changes.starts_moving);
  take("no_images", &changes.no_images);
  take("sonar_ahead", &changes.sonar_ahead);
  std::map<std::string, bool> effects;
  take("effects", &effects);
  for (const auto& [name, on] : effects) changes.effects.push_back(name + (on ? "=on" : "=off"));
  for (const auto& [key, value] : rest)
    throw UsageError("simulate: there is no argument '" + py::str(key).cast<std::string>() + "'");
  return changes;
}

}  // namespace

void bindSimulation(py::module_& module) {
  module.def(
      "simulate",
      [](const std::string& scenario, const fs::path& folder, int threads, const py::object& progress,
         const py::kwargs& changes) {
        const RecordingSummary summary =
            simulate(makeScenario(scenario, changesFrom(changes)), folder, threads, progress);
        py::dict result;
        result["path_length_m"] = summary.path_length_m;
        result["duration_s"] = summary.duration_s;
        result["images"] = summary.images.total;
        result["complete"] = summary.complete;
        return result;
      },
      py::arg("scenario"), py::arg("folder"), py::kw_only(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Simulates a dive into a folder: mav0 (EuRoC layout) and truth. scenarios() has the names.\n\n"
      "threads: for rendering, 0 for all cores. progress: called with (images done, images in all) now and\n"
      "then; it ends the simulation by returning False or raising, and so does Ctrl-C. The same call goes "
      "on\n"
      "from there. Changes to the scenario: seconds, metres, seed, cave_seed, dive_seed, cave_metres, laps,\n"
      "entrance, tags, width_px, height_px, cameras, camera_rate_hz, imu_rate_hz, magnetometer_rate_hz, "
      "imu,\n"
      "camera_model, readout_ms, realism, effects (a dict of names and bools), starts_moving, no_images,\n"
      "sonar_ahead; docs/how-to/simulate.md has their meaning. Returns a dict with path_length_m, "
      "duration_s,\n"
      "images and complete.");
  module.def(
      "scenarios",
      [] {
        py::dict result;
        for (const Scenario& scenario : scenarios()) result[py::str(scenario.name)] = scenario.description;
        return result;
      },
      "Scenarios of simulate(): names and descriptions.");
  module.def(
      "effects",
      [] {
        py::dict result;
        for (const EffectDescription& effect : effectDescriptions())
          result[py::str(std::string(effect.name))] = std::string(effect.what);
        return result;
      },
      "Effects of simulate(): names and what they do.");
}

}  // namespace lodeline::python

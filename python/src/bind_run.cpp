#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <array>

#include "lodeline/output/report/page/page_template.h"
#include "lodeline/pipeline/run_outcome.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/pipeline/run_report.h"
#include "python/src/arrays.h"
#include "python/src/bag_arguments.h"
#include "python/src/bindings.h"
#include "python/src/estimate_table.h"

namespace lodeline::python {
namespace {

namespace fs = std::filesystem;

/// A finished run.
struct RunResult {
  RunRequest request;
  Diagnostics diagnostics;
  RunSummary summary;
  EstimateTable estimates;
};

/// Lets Python look at an estimate. It returns whether the run goes on: not after an exception, which is
/// kept, after Ctrl-C, or when the callback returned False.
bool goesOn(const FrameEstimate& estimate, const py::object& progress, std::exception_ptr* raised) {
  const py::gil_scoped_acquire acquired;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return progress.is_none() || !endsWork(progress(estimate));
  } catch (...) {
    *raised = std::current_exception();
    return false;
  }
}

/// Runs the session packet by packet. The files of a run that ends early are completed, then the exception
/// of Python is thrown again.
std::unique_ptr<RunResult> execute(const RunRequest& request, const py::object& progress) {
  auto result = std::make_unique<RunResult>();
  result->request = request;
  std::exception_ptr raised;
  withoutGil([&] {
    RecordingRun run(request, &result->diagnostics);
    RunSession& session = run.session();
    for (bool goes_on = true; session.fetch() && goes_on;) {
      session.process();
      if (session.hasNewStamp()) result->estimates.add(session.estimate());
      result->estimates.add(session.landmarks());
      goes_on = goesOn(session.estimate(), progress, &raised);
    }
    result->summary = session.finish();
    result->estimates.add(session.odometry().estimator().currentMapPoints());
    result->estimates = result->estimates.turnedToNorth();
    if (!request.no_report && result->summary.posed() > 0) writeRunReport(request);
  });
  if (raised) std::rethrow_exception(raised);
  return result;
}

/// Where a dive began in a map; sigmas that are not given are those of the program.
std::optional<DiveStart> startOf(const std::optional<std::array<double, 3>>& position_m,
                                 const std::optional<std::array<double, 2>>& sigmas_m) {
  if (!position_m) {
    if (sigmas_m) throw UsageError("run: start_sigma needs start");
    return std::nullopt;
  }
  DiveStart start;
  start.position = Vec3(position_m->data());
  if (sigmas_m) {
    start.horizontal_sigma_m = (*sigmas_m)[0];
    start.vertical_sigma_m = (*sigmas_m)[1];
  }
  start.check();
  return start;
}

std::unique_ptr<RunResult> run(const fs::path& data, const std::optional<fs::path>& output,
                               const py::dict& settings, const std::optional<fs::path>& config,
                               const std::vector<fs::path>& rig,
                               const std::map<std::string, std::string>& topics, bool received_times,
                               const std::optional<fs::path>& magnetometer_calibration,
                               const std::optional<fs::path>& map,
                               const std::optional<std::array<double, 3>>& start,
                               const std::optional<std::array<double, 2>>& start_sigma,
                               const std::optional<double>& refine_interval_s, bool report, bool overwrite,
                               bool check, const py::object& progress) {
  RunRequest request;
  request.data = data.string();
  request.output = output.value_or(fs::path()).string();
  request.config = config.value_or(fs::path()).string();
  request.bag = bagArguments(rig, topics, received_times);
  request.map = map.value_or(fs::path()).string();
  request.map_start = startOf(start, start_sigma);
  request.magnetometer_calibration = magnetometer_calibration.value_or(fs::path()).string();
  request.refine_interval_s = refine_interval_s;
  request.no_report = !report;
  request.sample_pictures = report && !pageTemplate().empty();
  request.overwrite = overwrite;
  for (const auto& [key, value] : settings)
    request.overrides.push_back(py::str(key).cast<std::string>() + "=" + yamlText(value));
  if (request.output.empty() && (report || map || refine_interval_s))
    throw UsageError("run: report, map and refine_interval_s need an output folder");
  if (start && !map) throw UsageError("run: start needs a map");
  std::unique_ptr<RunResult> result = execute(request, progress);
  if (check && !result->summary.interrupted)
    requireResult(result->request, result->summary, result->diagnostics);
  return result;
}

void bindRunResult(py::module_& module) {
  using Type = const RunResult&;
  py::class_<RunResult>(module, "Run", "A finished run.")
      .def_property_readonly(
          "estimates", [](Type r) { return &r.estimates; }, py::return_value_policy::reference_internal,
          "arrays, as in the files: in a world with y to north where north was found")
      .def_property_readonly(
          "output",
          [](Type r) -> std::optional<fs::path> {
            return r.request.output.empty() ? std::nullopt : std::optional<fs::path>(r.request.output);
          },
          "folder of the files; or None")
      .def_property_readonly(
          "summary", [](Type r) { return fromJson(r.summary.json(r.diagnostics)); }, "run.json as a dict")
      .def_property_readonly(
          "findings", [](Type r) { return findingsOf(r.diagnostics); }, "most severe first")
      .def_property_readonly(
          "was_stopped", [](Type r) { return r.summary.interrupted; }, "whether `progress` ended the run")
      .def("__str__", [](Type r) { return printable(r.summary.text(r.diagnostics)); });
}

}  // namespace

void bindRun(py::module_& module) {
  bindRunResult(module);
  module.def(
      "run", &run, py::arg("data"), py::arg("output") = py::none(), py::kw_only(),
      py::arg("settings") = py::dict(), py::arg("config") = py::none(),
      py::arg("rig") = std::vector<fs::path>(), py::arg("topics") = std::map<std::string, std::string>(),
      py::arg("received_times") = false, py::arg("magnetometer_calibration") = py::none(),
      py::arg("map") = py::none(), py::arg("start") = py::none(), py::arg("start_sigma") = py::none(),
      py::arg("refine_interval_s") = py::none(), py::arg("report") = false, py::arg("overwrite") = false,
      py::arg("check") = true, py::arg("progress") = py::none(),
      "Estimates a trajectory and a map from a recording, as `lodeline run` does, with the same files.\n\n"
      "data: folder with mav0, or a bag. output: folder for the files; without one, none are written.\n"
      "settings: values by the keys of docs/reference/settings.md, over those of the file config.\n"
      "rig, topics, received_times: see Recording. magnetometer_calibration, map: files.\n"
      "start: (east, north, up), m from the origin of the map, at which the dive began. start_sigma: "
      "(horizontal,\n"
      "vertical), m: how well that is known, by default (3, 1). Both need map.\n"
      "refine_interval_s: also compute the batch solution, with states at most so far apart.\n"
      "report: write report.html. overwrite: replace another run in the folder.\n"
      "check: raise EstimationError or InputError where there is no result, or one that is not to be "
      "trusted.\n"
      "progress: called with the Estimate of each frame. It ends the run by returning False or raising;\n"
      "so does Ctrl-C. The files then hold the results so far.\n\n"
      "OpenCV uses one thread in the process from then on, so that results are the same on every machine.");
}

}  // namespace lodeline::python

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <variant>

#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/report/read_reported_uncertainty.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/json_text.h"
#include "python/src/arrays.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

namespace fs = std::filesystem;

/// A comparison and its findings.
struct EvaluationResult {
  Evaluation evaluation;
  Diagnostics diagnostics;
};

using TrajectoryOrPath = std::variant<Trajectory, fs::path>;

Trajectory trajectoryOf(const TrajectoryOrPath& given, Diagnostics* diagnostics) {
  if (const auto* trajectory = std::get_if<Trajectory>(&given)) return *trajectory;
  return readTrajectory(std::get<fs::path>(given), {}, *diagnostics);
}

EvaluationResult evaluateBoth(const TrajectoryOrPath& estimate, const TrajectoryOrPath& reference,
                              const EvaluationOptions& options) {
  EvaluationResult result;
  const Trajectory both[] = {trajectoryOf(estimate, &result.diagnostics),
                             trajectoryOf(reference, &result.diagnostics)};
  result.evaluation = evaluate(both[0], both[1], options, result.diagnostics);
  if (const auto* run = std::get_if<fs::path>(&estimate))
    result.evaluation.claims = checkReported(*run, both[1], options.association, &result.diagnostics);
  return result;
}

void bindEvaluationResult(py::module_& module) {
  using Type = const EvaluationResult&;
  py::class_<EvaluationResult>(module, "Evaluation", "Errors of an estimate at N pairs of poses.")
      .def_property_readonly(
          "ate_rmse_m", [](Type r) { return r.evaluation.absolute.position().rmse; },
          "absolute trajectory error: RMS of the position errors after the alignment, m")
      .def_property_readonly(
          "rotation_rmse_deg", [](Type r) { return r.evaluation.absolute.rotation().rmse; }, "degrees")
      .def_property_readonly(
          "scale_error", [](Type r) { return r.evaluation.alignment.scaleError(); },
          "of the alignment sim3: positive where the estimate is too large")
      .def_property_readonly(
          "figures", [](Type r) { return fromJson(jsonText(evaluationJson(r.evaluation, r.diagnostics))); },
          "all figures as `lodeline evaluate --json` writes them: absolute and relative errors, completion")
      .def_property_readonly(
          "times_ns", [](Type r) { return timeColumn(r.evaluation.pairs.time, [](Time t) { return t; }); },
          "(N) int64, ns, on the clock of the reference")
      .def_property_readonly(
          "aligned_poses",
          [](Type r) {
            return stack(r.evaluation.aligned_estimate, [](const Rigid3& p) { return p.matrix(); });
          },
          "(N, 4, 4), of the estimate in the world of the reference, m")
      .def_property_readonly(
          "reference_poses",
          [](Type r) {
            return stack(r.evaluation.pairs.reference, [](const Rigid3& p) { return p.matrix(); });
          },
          "(N, 4, 4), m")
      .def_property_readonly(
          "position_errors_m",
          [](Type r) { return stack(r.evaluation.absolute.position_m, [](const Vec3& e) { return e; }); },
          "(N, 3), estimate minus reference, m")
      .def_property_readonly(
          "rotation_errors_deg",
          [](Type r) {
            return column<double>(r.evaluation.absolute.rotation_deg, [](double e) { return e; });
          },
          "(N), degrees")
      .def_property_readonly(
          "yaw_errors_deg",
          [](Type r) { return column<double>(r.evaluation.absolute.yaw_deg, [](double e) { return e; }); },
          "(N), signed, degrees")
      .def_property_readonly(
          "distances_m",
          [](Type r) {
            return column<double>(r.evaluation.reference_distance_m, [](double d) { return d; });
          },
          "(N), path of the reference from the first pair, m")
      .def_property_readonly(
          "relative",
          [](Type r) {
            py::list lengths;
            for (const RelativeErrors& errors : r.evaluation.relative) {
              py::dict row;
              row["length_m"] = errors.length_m;
              row["translation_m"] = column<double>(errors.translation_m, [](double e) { return e; });
              row["rotation_deg"] = column<double>(errors.rotation_deg, [](double e) { return e; });
              lengths.append(row);
            }
            return lengths;
          },
          "relative pose errors: for each length a dict with length_m, translation_m (K), rotation_deg (K)")
      .def_property_readonly("findings", [](Type r) { return findingsOf(r.diagnostics); })
      .def("__str__",
           [](Type r) { return printable(evaluationTable(r.evaluation) + findingsText(r.diagnostics)); });
}

}  // namespace

void bindEvaluation(py::module_& module) {
  bindEvaluationResult(module);
  module.def(
      "evaluate",
      [](const TrajectoryOrPath& estimate, const TrajectoryOrPath& reference, const std::string& align,
         size_t align_pairs, double time_offset_s, double time_tolerance_s, bool interpolate,
         const std::vector<double>& stretches_m, const std::optional<fs::path>& images) {
        EvaluationOptions options;
        options.alignment = alignmentTypeFromString(align);
        options.alignment_pairs = align_pairs;
        options.association.time_offset_s = time_offset_s;
        options.association.tolerance_s = time_tolerance_s;
        if (interpolate) options.association.method = AssociationMethod::Interpolate;
        options.stretch_lengths_m = stretches_m;
        if (images) options.expected_stamps = readImageStamps(*images);
        return withoutGil([&] { return evaluateBoth(estimate, reference, options); });
      },
      py::arg("estimate"), py::arg("reference"), py::kw_only(), py::arg("align") = "se3",
      py::arg("align_pairs") = 0, py::arg("time_offset_s") = 0.0, py::arg("time_tolerance_s") = 0.01,
      py::arg("interpolate") = false, py::arg("stretches_m") = std::vector<double>(),
      py::arg("images") = py::none(),
      "Compares an estimate with a reference: absolute and relative errors (ATE, RPE).\n\n"
      "estimate, reference: Trajectory, file or folder. align: none, yaw, se3 or sim3. align_pairs: align "
      "on\n"
      "the first so many pairs, 0 for all. time_offset_s is added to the estimate's times. "
      "time_tolerance_s:\n"
      "largest difference of times in a pair. interpolate: the reference at the estimate's times.\n"
      "stretches_m: lengths for relative errors; by default 10 to 50 % of the path. images: a EuRoC "
      "camera's\n"
      "data.csv or folder, for the completion. For the folder of a run, the figures compare errors with the\n"
      "reported sigmas as well.");
}

}  // namespace lodeline::python

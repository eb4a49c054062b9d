#include "lodeline/trajectory.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/errors/orientation_order.h"
#include "lodeline/evaluation/errors/pose_convention.h"

namespace lodeline {
namespace {

// Relative tolerance of a section's length (Zhang & Scaramuzza's toolbox uses the same).
constexpr double kStretchTolerance = 0.2;

PosePairs firstPairs(const PosePairs& pairs, std::size_t count) {
  if (count == 0 || count >= pairs.size()) return pairs;
  const auto end = static_cast<std::ptrdiff_t>(count);
  return {{pairs.time.begin(), pairs.time.begin() + end},
          {pairs.estimate.begin(), pairs.estimate.begin() + end},
          {pairs.reference.begin(), pairs.reference.begin() + end}};
}

double roundTo2Digits(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::round(value / unit) * unit;
}

std::vector<double> stretchLengths(const EvaluationOptions& options, double path_m) {
  if (!options.stretch_lengths_m.empty()) return options.stretch_lengths_m;
  std::vector<double> lengths_m;
  if (path_m > 0.0) {
    for (const double share : {0.1, 0.2, 0.3, 0.4, 0.5}) {
      lengths_m.push_back(roundTo2Digits(share * path_m));
    }
  }
  return lengths_m;
}

void computeRelative(Evaluation& e, Diagnostics& diagnostics) {
  const auto& aligned = e.aligned_estimate;
  for (const double length_m : stretchLengths(e.options, e.reference_path_m)) {
    const auto stretches =
        overlappingStretches(e.reference_distance_m, length_m, kStretchTolerance * length_m);
    if (stretches.empty()) {
      diagnostics.report(
          Severity::Notice, "no_stretch",
          fmt::format("no stretch of {:g} m in a path of {:.1f} m", length_m, e.reference_path_m));
      continue;
    }
    e.relative.push_back(computeRelativeErrors(aligned, e.pairs.reference, stretches, length_m));
  }
  // Selected along the estimate as in evo, so that the results are comparable.
  const double length_m = e.options.consecutive_length_m;
  const auto consecutive = consecutiveStretches(distancesFromStart(aligned), length_m);
  e.consecutive = computeRelativeErrors(aligned, e.pairs.reference, consecutive, length_m);
}

void computeEndPoint(Evaluation& e) {
  const Vec3& end = e.pairs.reference.back().translation;
  e.end_point_m = (e.aligned_estimate.back().translation - end).norm();
  const Alignment at_start = alignFirstPose(e.options.alignment, e.pairs, e.alignment.scale);
  e.drift_m = (at_start.apply(e.pairs.estimate.back()).translation - end).norm();
}

void reportAlignment(const Evaluation& e, Diagnostics& diagnostics) {
  if (!e.alignment.rotation_from_orientations) return;
  diagnostics.report(
      Severity::Warning, "alignment_degenerate",
      fmt::format("the positions of the {} pairs do not fix the rotation of a {} alignment (no "
                  "extent, or one line); it was taken from the orientations",
                  e.pairs.size(), toString(e.options.alignment)));
}

Completion computeCompletion(const Evaluation& e) {
  const Duration offset = Duration::fromSeconds(e.options.association.time_offset_s);
  if (e.options.expected_stamps.empty()) return completionByTime(e.estimate, e.reference, offset);
  return completionByImages(e.estimate, e.options.expected_stamps, offset,
                            Duration::fromSeconds(e.options.association.tolerance_s));
}

}  // namespace

double Evaluation::percentOfPath(double length_m) const {
  return reference_path_m > 0.0 ? 100.0 * length_m / reference_path_m : 0.0;
}

Evaluation evaluate(const Trajectory& estimate, const Trajectory& reference, const EvaluationOptions& options,
                    Diagnostics& diagnostics) {
  Evaluation e;
  e.options = options;
  e.estimate = withZUp(estimate);
  e.reference = withZUp(reference);
  e.pairs = associate(e.estimate, e.reference, options.association);
  if (!checkPoseConvention(e.pairs, options.alignment, diagnostics))
    checkOrientationOrder(e.pairs, diagnostics);
  e.alignment = align(options.alignment, firstPairs(e.pairs, options.alignment_pairs));
  reportAlignment(e, diagnostics);
  e.aligned_estimate = applyAlignment(e.alignment, e.pairs.estimate);
  e.absolute = computeAbsoluteErrors(e.aligned_estimate, e.pairs.reference);
  e.reference_distance_m = distancesFromStart(e.pairs.reference);
  e.reference_path_m = e.reference_distance_m.back();
  e.estimate_path_m = distancesFromStart(e.pairs.estimate).back();
  computeRelative(e, diagnostics);
  computeEndPoint(e);
  e.completion = computeCompletion(e);
  return e;
}

}  // namespace lodeline

#include "lodeline/magnetometer/iron/iron_calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/iron/ellipsoid_fit.h"
#include "lodeline/magnetometer/iron/heading_error.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kNominalField_T = 50e-6;
/// Plausible field magnitudes. A sensor's own scale may be wrong, but noise about one value is not a field.
constexpr double kLeastField_T = 8e-6, kMostField_T = 200e-6;
constexpr double kLeastRadius_counts = 20.0;

using EllipsoidFit = std::optional<Ellipsoid> (*)(std::span<const Vec3>);

/// An ellipsoid with the sum of squared distances of the nearest three quarters of the readings.
struct TrimmedFit {
  Ellipsoid ellipsoid;
  double sum = 0.0;
  std::vector<Vec3> nearest;
};

TrimmedFit trimmed(const Ellipsoid& ellipsoid, std::span<const Vec3> readings) {
  std::vector<std::pair<double, size_t>> ranked;
  for (size_t i = 0; i < readings.size(); ++i) {
    const IronResidual r = ironResidual(readings[i], {ellipsoid.matrix, ellipsoid.centre});
    ranked.emplace_back(std::abs(r.distance), i);
  }
  std::sort(ranked.begin(), ranked.end());
  TrimmedFit result{ellipsoid, 0.0, {}};
  for (size_t i = 0; i < ranked.size() * 3 / 4; ++i) {
    result.sum += ranked[i].first * ranked[i].first;
    result.nearest.push_back(readings[ranked[i].second]);
  }
  return result;
}

/// Refits the ellipsoid several times to the readings with the smallest residuals.
std::optional<TrimmedFit> concentrated(EllipsoidFit fit, std::span<const Vec3> begin,
                                       std::span<const Vec3> readings, int rounds) {
  std::optional<Ellipsoid> ellipsoid = fit(begin);
  if (!ellipsoid) return std::nullopt;
  TrimmedFit best = trimmed(*ellipsoid, readings);
  for (int round = 0; round < rounds; ++round) {
    ellipsoid = fit(best.nearest);
    if (!ellipsoid) break;
    best = trimmed(*ellipsoid, readings);
  }
  return best;
}

/// Least trimmed squares (Rousseeuw & Van Driessen, "Computing LTS regression for large data sets", 2006). It
/// starts from all readings and from small random samples, most of which have no outlier. An outlier among
/// all readings can shift the first fit so much that it is never rejected. A sample is used where it more
/// than halves the spread. `rounds` of refitting to the nearest readings follow. The samples are the same in
/// every run.
std::optional<Ellipsoid> trimmedEllipsoid(EllipsoidFit fit, std::span<const Vec3> readings, int rounds) {
  constexpr int kSamples = 60;
  constexpr size_t kSampleSize = 14, kMostReadings = 1000;
  std::optional<TrimmedFit> best = concentrated(fit, readings, readings, rounds);
  std::vector<Vec3> thinned;
  const size_t stride = readings.size() / kMostReadings + 1;
  for (size_t i = 0; i < readings.size(); i += stride) thinned.push_back(readings[i]);
  std::optional<TrimmedFit> best_sample;
  std::mt19937 random(1);
  for (int k = 0; k < kSamples; ++k) {
    std::vector<Vec3> sample;
    for (size_t i = 0; i < kSampleSize; ++i) sample.push_back(thinned[random() % thinned.size()]);
    std::optional<TrimmedFit> found = concentrated(fit, sample, thinned, 1);
    if (found && (!best_sample || found->sum < best_sample->sum)) best_sample = std::move(found);
  }
  if (best_sample) {
    const std::optional<TrimmedFit> found = concentrated(fit, best_sample->nearest, readings, rounds);
    if (found && (!best || found->sum < 0.25 * best->sum)) best = found;
  }
  return best ? std::optional(best->ellipsoid) : std::nullopt;
}

/// Initial values for the refinement of each model; the best result is used.
std::vector<IronParameters> startsOf(IronModel model, std::span<const Vec3> readings,
                                     const IronCalibrationOptions& options) {
  std::vector<IronParameters> starts;
  if (model == IronModel::Full) {
    if (const auto ellipsoid = trimmedEllipsoid(&fitEllipsoid, readings, 4))
      starts.push_back({ellipsoid->matrix, ellipsoid->centre});
    return starts;
  }
  Mat3 shape = Mat3::Identity();  // with determinant 1
  if (options.old) {
    shape = options.old->iron_correction / std::cbrt(options.old->iron_correction.determinant());
  }
  const std::optional<Ellipsoid> sphere = trimmedEllipsoid(&fitSphere, readings, 0);
  if (model == IronModel::Offset) {
    const Mat3 correction = (options.old ? options.old->iron_correction : shape) / *options.field_strength_T;
    starts.push_back({correction, options.old ? options.old->hard_iron : Vec3::Zero()});
    if (sphere) starts.push_back({correction, sphere->centre});
  } else if (sphere) {
    starts.push_back({shape * sphere->matrix(0, 0), sphere->centre});
  }
  return starts;
}

std::optional<IronFit> bestFit(IronModel model, std::span<const Vec3> readings,
                               const IronCalibrationOptions& options) {
  std::optional<IronFit> best;
  IronFitOptions fit_options;
  fit_options.model = model;
  if (options.old) fit_options.left_out_scale_sigma = fit_options.left_out_skew_sigma = 0.01;
  for (const IronParameters& start : startsOf(model, readings, options)) {
    try {
      IronFit fit = fitIron(readings, start, fit_options);
      if (!best || fit.sigma < best->sigma) best = std::move(fit);
    } catch (const EstimationError&) {
      // Another initial value or a simpler model may succeed.
    }
  }
  return best;
}

IronCalibration describe(IronModel model, std::span<const Vec3> readings, const IronFit& fit,
                         const IronCalibrationOptions& options) {
  IronCalibration result;
  result.used = fit.used;
  result.correlation_factor = fit.correlation_factor;
  MagnetometerFit& out = result.fit;
  out.model = model;
  out.raw_readings = options.raw_readings;
  out.iron_correction = fit.parameters.correction;
  out.hard_iron = fit.parameters.hard_iron;
  out.covariance.topLeftCorner<9, 9>() = fit.covariance;
  out.field_strength_T = 1.0;
  settleScale(options.field_strength_T, &out);
  out.condition_number = fit.condition_number;
  double square = 0.0;
  for (size_t i = 0; i < readings.size(); ++i) {
    if (!fit.used[i]) continue;
    const Vec3 field_M = out.corrected_M(readings[i]);
    result.coverage.add(field_M);
    square += std::pow(field_M.norm() - out.field_strength_T, 2);
    ++out.readings;
  }
  out.residual_T = std::sqrt(square / std::max(1, out.readings));
  out.rejected_share = 1.0 - static_cast<double>(out.readings) / static_cast<double>(readings.size());
  out.coverage_share = result.coverage.share();
  out.heading_error_rad = headingSigma(out, options.dip_rad);
  return result;
}

/// Reason to reject the result; empty where it is accepted.
std::string objection(const IronCalibration& result, const ModelRequirement& requirement,
                      const IronCalibrationOptions& options) {
  const MagnetometerFit& fit = result.fit;
  const double residual_share = fit.residual_T / fit.field_strength_T;
  const Vec3 scales = Eigen::SelfAdjointEigenSolver<Mat3>(fit.iron_correction).eigenvalues();
  const double radius = fit.field_strength_T / std::cbrt(fit.iron_correction.determinant());
  if (fit.raw_readings && radius < kLeastRadius_counts) {
    return fmt::format("the readings lie within {:.1f} counts of each other; was the sensor turned?", radius);
  }
  if (!fit.raw_readings && !(radius > kLeastField_T && radius < kMostField_T)) {
    return fmt::format(
        "by the sensor's own scale the field would have {:.1f} uT where the Earth's has 22 to 67; was the "
        "sensor "
        "turned, away from iron?",
        1e6 * radius);
  }
  if (fit.coverage_share < requirement.coverage_share) {
    return fmt::format("the readings cover {:.0f} % of the sphere of directions and it takes {:.0f} %",
                       100.0 * fit.coverage_share, 100.0 * requirement.coverage_share);
  }
  if (!(fit.condition_number < requirement.condition_number)) {
    return fmt::format("the condition number is {:.1e} and must be below {:.0e}", fit.condition_number,
                       requirement.condition_number);
  }
  if (scales.maxCoeff() > options.greatest_axis_ratio * scales.minCoeff()) {
    return fmt::format("the ellipsoid's axes are as {:.1f} to 1, which no usable sensor shows",
                       scales.maxCoeff() / scales.minCoeff());
  }
  if (residual_share > options.greatest_residual_share) {
    return fmt::format("the residual is {:.1f} % of the field and may be {:.1f} %", 100.0 * residual_share,
                       100.0 * options.greatest_residual_share);
  }
  if (fit.rejected_share > options.greatest_rejected_share) {
    return fmt::format("{:.0f} % of the readings do not fit", 100.0 * fit.rejected_share);
  }
  if (!(fit.heading_error_rad < options.greatest_heading_error_rad)) {
    return fmt::format("its equivalent heading error would be {:.1f} degrees",
                       fit.heading_error_rad / kDegree);
  }
  return {};
}

const char* describe(IronModel model) {
  switch (model) {
    case IronModel::Full:
      return "the full model (soft and hard iron)";
    case IronModel::Diagonal:
      return "the model of three scales and the offset";
    case IronModel::Scale:
      return "the model of one scale and the offset";
    case IronModel::Offset:
      return "a fit of the offset alone";
    case IronModel::Kept:
      break;
  }
  return "the old calibration";
}

}  // namespace

IronCalibration calibrateIron(std::span<const Vec3> readings, const IronCalibrationOptions& options) {
  if (static_cast<int>(readings.size()) < options.fewest_readings) {
    throw EstimationError(
        fmt::format("{} usable magnetometer readings where at least {} are needed; record the "
                    "sensor for a minute while it is turned in all directions",
                    readings.size(), options.fewest_readings));
  }
  const std::vector<std::pair<IronModel, ModelRequirement>> ladder = {{IronModel::Full, options.full},
                                                                      {IronModel::Diagonal, options.diagonal},
                                                                      {IronModel::Scale, options.scale},
                                                                      {IronModel::Offset, options.offset}};
  std::vector<std::string> refusals;
  SphereCoverage coverage;
  for (const auto& [model, requirement] : ladder) {
    std::string why = "the size of the field is not known (--site and --date tell it)";
    if (model != IronModel::Offset || options.field_strength_T) {
      why = "no ellipsoid passes through the readings";
      if (const std::optional<IronFit> fit = bestFit(model, readings, options)) {
        IronCalibration result = describe(model, readings, *fit, options);
        why = objection(result, requirement, options);
        if (why.empty()) {
          result.refusals = std::move(refusals);
          return result;
        }
        coverage = result.coverage;
      }
    }
    refusals.push_back(fmt::format("{} was passed over: {}", describe(model), why));
  }
  if (options.old) {
    IronCalibration kept;
    kept.fit = *options.old;
    kept.fit.model = IronModel::Kept;
    kept.used.assign(readings.size(), false);
    kept.refusals = std::move(refusals);
    return kept;
  }
  throw EstimationError(fmt::format("these readings cannot calibrate the magnetometer:\n  {}\n{}",
                                    fmt::join(refusals, "\n  "), howToMove(coverage)));
}

std::string howToMove(const SphereCoverage& coverage) {
  // A side counts as covered where a bin within 45 degrees of it was reached.
  std::vector<std::string> unseen;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      bool seen = false;
      for (int zone = 0; zone < SphereCoverage::kZones; ++zone) {
        for (int sector = 0; sector < SphereCoverage::kSectors; ++sector) {
          const double cosine = sign * SphereCoverage::middle(zone, sector)[axis];
          seen = seen || (coverage.count(zone, sector) > 0 && cosine > 0.7);
        }
      }
      if (!seen) unseen.push_back(fmt::format("{}{}", sign > 0 ? '+' : '-', "xyz"[axis]));
    }
  }
  std::string advice =
      "How to move: away from iron, hold the sensor with each of its six sides up in turn and turn it once "
      "around each time, or swing it in figures of eight while rolling it over; 60 to 90 s in all.";
  if (!unseen.empty()) {
    advice += fmt::format(" The field has not yet pointed along the sensor's {}.", fmt::join(unseen, ", "));
  }
  return advice;
}

void settleScale(std::optional<double> field_strength_T, MagnetometerFit* fit) {
  using Mat12 = MagnetometerFit::Covariance;
  const double before = std::cbrt(fit->iron_correction.determinant());
  Mat12 change = Mat12::Identity();
  double factor = 1.0;
  fit->field_strength_known = field_strength_T.has_value();
  if (field_strength_T || fit->raw_readings) {
    factor = field_strength_T.value_or(kNominalField_T) / fit->field_strength_T;
    change.topLeftCorner<6, 6>() *= factor;
  } else {
    // A' = A / det(A)^(1/3):  dA' = (dA - A trace(A^-1 dA) / 3) / det(A)^(1/3).
    factor = 1.0 / before;
    const Mat3 inverse = fit->iron_correction.inverse();
    Eigen::Matrix<double, 1, 6> trace;
    trace << inverse(0, 0), inverse(1, 1), inverse(2, 2), 2.0 * inverse(0, 1), 2.0 * inverse(0, 2),
        2.0 * inverse(1, 2);
    change.topLeftCorner<6, 6>() -= symmetricEntries(fit->iron_correction) * trace / 3.0;
    change.topLeftCorner<6, 6>() *= factor;
  }
  fit->iron_correction *= factor;
  fit->field_strength_T *= factor;
  fit->residual_T *= factor;
  fit->covariance = (change * fit->covariance * change.transpose()).eval();
}

}  // namespace lodeline

// Functions of MagnetometerFusion that determine north: at the start, later, and after a replacement of the
// field.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/ahrs/field_gate.h"
#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kToFindNorth_s = 1.0;  // time without north before the first report

double azimuthBetween(const Vec3& from_W, const Vec3& to_W) {
  return std::remainder(std::atan2(to_W.y(), to_W.x()) - std::atan2(from_W.y(), from_W.x()),
                        2.0 * std::numbers::pi);
}

/// Reports a field that points up where no site in the southern hemisphere was stated.
void reportFieldUpwards(const Vec3& field_W, const MagnetometerOptions& options, Diagnostics* diagnostics) {
  constexpr double kTellingDip_rad = 10.0 * kDegree;
  const double dip_rad = FieldShape::of(field_W).dip_rad;
  if (options.site_field_W || dip_rad > -kTellingDip_rad) return;
  diagnostics->report(
      Severity::Warning, "magnetic_field_upwards",
      fmt::format(
          "magnetometer: the field dips by {:.1f} degrees, as it does south of the magnetic equator. North "
          "of it the magnetometer's axes are left-handed or of reversed sign, and heading is off by up to "
          "180 degrees; --site and --date tell",
          dip_rad * kDegreesPerRadian));
}

}  // namespace

void MagnetometerFusion::align(Window* window, Prior* prior) {
  Vec3 sum_W = Vec3::Zero();
  int count = 0;
  for (const auto& frame : window->frames()) {
    const auto mean = means_.find(frame->time);
    if (mean == means_.end()) continue;
    sum_W += frame->worldFromBody().rotation * withoutCurrents(mean->second, nullptr).field_B;
    ++count;
  }
  if (count == 0) return;
  const MagnetometerOptions& wanted = options_.magnetometer;
  const HeadingAlignment alignment = alignHeading(sum_W / count, wanted);
  if (!alignment.refusal.empty()) reportNorthMissing(started_, alignment.refusal);
  heading_reference_ = alignment.reference;
  reportFieldUpwards(alignment.field_W, wanted, diagnostics_);
  if (heading_reference_ != HeadingReference::Start) {
    // The heading of the first pose stays, and the azimuth of the field is estimated. Where the first field
    // is that of iron, north moves later, and not the path.
    turnWorld(alignment.yaw_rad, window, prior);
    north_found_ = started_;
    relative_field_W_ = alignment.field_W;
  }
  if (absolute()) addStates(alignment, window, prior);
}

void MagnetometerFusion::reportNorthMissing(Time time, const std::string& reason) {
  if (north_missing_reported_) return;
  north_missing_reported_ = true;
  diagnostics_->report(
      Severity::Warning, "heading_not_aligned",
      fmt::format(
          "heading counts from the first pose, not from north, at {} ns: {}; north is looked for with "
          "every frame until it is found",
          time.nanoseconds(), reason));
}

void MagnetometerFusion::findNorth(const Vec3& field_W, Time time) {
  const MagnetometerOptions& wanted = options_.magnetometer;
  if (heading_reference_ != HeadingReference::Start || wanted.heading_reference == HeadingReference::Start)
    return;
  const HeadingAlignment alignment = alignHeading(field_W, wanted);
  if (!alignment.refusal.empty()) return reportNorthMissing(time, alignment.refusal);
  heading_reference_ = alignment.reference;
  north_found_ = time;
  relative_field_W_ = field_W;
  reportFieldUpwards(field_W, wanted, diagnostics_);
  if (!north_missing_reported_) return;
  diagnostics_->report(
      Severity::Notice, "north_found",
      fmt::format("{} was found at {} ns, {:.1f} s after the first pose; the files of the "
                  "finished run count heading from it, from the first pose on",
                  toString(heading_reference_), time.nanoseconds(), (time - started_).seconds()));
}

void MagnetometerFusion::missField(const Window& window) {
  const bool is_missing = heading_reference_ == HeadingReference::Start &&
                          options_.magnetometer.heading_reference != HeadingReference::Start &&
                          MagnetometerStates(window).field == nullptr;
  const Time now = window.newest().time;
  if (is_missing && (now - started_).seconds() > kToFindNorth_s)
    reportNorthMissing(now, "no magnetometer reading since the start");
}

bool MagnetometerFusion::takeBetterField(const FrameField& field, Window& window,
                                         Marginalizer& marginalizer) {
  const MagnetometerOptions& wanted = options_.magnetometer;
  // An uncalibrated magnetometer has an error field that rotates with the rig and fits no constant field.
  if (!calibration_.is_calibrated || wanted.heading_reference == HeadingReference::Start) return false;
  const MagnetometerStates states(window);
  const auto isPlausible = [&](const Vec3& field_W) { return alignHeading(field_W, wanted).refusal.empty(); };
  const MagnetometerMean mean = withoutCurrents(field, &window);
  EarthFieldSearch::Reading reading;
  reading.time = mean.time;
  reading.field_W =
      window.newest().worldFromBody().rotation * (mean.field_B - mean.carried * states.offset_B());
  reading.agrees = status_ == MagnetometerStatus::Used;
  reading.is_plausible = isPlausible(reading.field_W);
  reading.is_field_in_force_plausible = isPlausible(states.field_W());
  const std::optional<Vec3> better_W = search_.add(reading);
  if (better_W) takeField(*better_W, field, window, marginalizer);
  return better_W.has_value();
}

void MagnetometerFusion::restartChecks() {
  gate_ = MagnetometerGate(options_.magnetometer.gate);
  comparison_.restart();
  errors_ = MagneticNoiseEstimator(options_.magnetometer, offsetSigma());
  deviation_ = StudentTWeight(options_.magnetometer);
  step_ = MagneticStepDetector(options_.magnetometer.step);
  anomaly_.restartAgreement();
  rejecting_ = false;
}

void MagnetometerFusion::takeField(const Vec3& field_W, const FrameField& field, Window& window,
                                   Marginalizer& marginalizer) {
  const MagnetometerStates states(window);
  const double moved_rad = azimuthBetween(states.field_W(), field_W);
  diagnostics_->report(
      Severity::Warning, "magnetic_field_replaced",
      fmt::format(
          "magnetometer: another field has held for longer, at {} ns, than the one that was taken for "
          "the Earth's at the start (a boat or tanks nearby?); north is moved by {:.1f} degrees, from "
          "the first pose on",
          field.mean.time.nanoseconds(), moved_rad * kDegreesPerRadian));
  for (const auto& frame : window.frames()) frame->measurements.remove<FieldMeasurement>();
  for (ParameterBlock* state : {states.field, states.offset, states.disturbance}) {
    marginalizer.forget(window, *state);
    std::fill(state->value.begin(), state->value.end(), 0.0);
    state->sudden_variance = 0.0;
  }
  std::copy_n(field_W.data(), 3, states.field->value.begin());
  marginalizer.addKnowledge(*states.field, Vec3::Constant(options_.magnetometer.field_sigma_T));
  marginalizer.addKnowledge(*states.offset, Vec3::Constant(offsetSigma()));
  restartChecks();
  disturbed_ = false;
  last_seen_.reset();
  least_tilt_variance_rad2_ = 0.0;
  ++field_epoch_;
  heading_reference_ = HeadingReference::Start;
  findNorth(field_W, field.mean.time);
  window.newest().measurements.set(measurementOf(field, 1.0, false));
  status_before_ = MagnetometerStatus::Used;
}

AzimuthCovariance MagnetometerFusion::azimuth(const Window& window) const {
  const MagnetometerStates states(window);
  if (states.field == nullptr) {
    const double sigma_T = std::hypot(offsetSigma(), floorSigma(relative_field_W_));
    return {std::pow(sigma_T / relative_field_W_.head<2>().norm(), 2), Eigen::Matrix<double, 15, 1>::Zero()};
  }
  const double* field = states.field->value.data();
  if (!covariance_.knows(field)) return {};
  Eigen::Matrix<double, 15, 3> state_field;
  state_field << covariance_.between(window.newest().pose.data(), field),
      covariance_.between(window.newest().motion.data(), field);
  return azimuthCovariance(states.field_W(), covariance_.between(field, field), state_field);
}

Vec3 MagnetometerFusion::northField(const Window& window) const {
  const MagnetometerStates states(window);
  return states.field ? states.field_W() : relative_field_W_;
}

void MagnetometerFusion::describeNorth(const Window& window, MagnetometerEstimate* estimate) const {
  estimate->heading_reference = heading_reference_;
  estimate->north_found = north_found_;
  estimate->field_epoch = field_epoch_;
  if (!north_found_) return;
  const Vec3 field_W = northField(window);
  estimate->north_from_world_rad = northFromWorld(field_W, heading_reference_, options_.magnetometer);
  estimate->north_from_world_sigma_rad = std::sqrt(azimuth(window).variance_rad2);
}

void MagnetometerFusion::relate(const Window& window, Eigen::Matrix<double, 15, 15>* covariance) const {
  if (!north_found_) return;
  AzimuthCovariance north = azimuth(window);
  if (MagnetometerStates(window).field != nullptr)
    north.variance_rad2 += std::pow(anomaly_.sigma_T() / northField(window).head<2>().norm(), 2);
  relateToNorth(window.newest().state(), north, covariance);
}

void MagnetometerFusion::report(const Window& window, SensorEstimates* estimates) const {
  estimates->set(estimate(window));
}

std::vector<BatchState> MagnetometerFusion::batchStates(const Window& window) const {
  if (MagnetometerStates(window).field == nullptr) return {};
  BatchState field{MagnetometerStates::kField};
  field.sigma = options_.magnetometer.field_sigma_T;
  BatchState offset{MagnetometerStates::kOffset};
  offset.walk_per_sqrt_s = options_.magnetometer.offset_walk_T_per_sqrt_s;
  offset.sigma = offsetSigma();
  offset.value = {0.0, 0.0, 0.0};
  field.is_start_replaced = offset.is_start_replaced = field_epoch_ > 0;
  std::vector<BatchState> states = {field, offset};
  if (currents_.isOnBoard()) {
    for (BatchState& state : currents_.batchStates(window)) states.push_back(std::move(state));
  }
  return states;
}

}  // namespace lodeline

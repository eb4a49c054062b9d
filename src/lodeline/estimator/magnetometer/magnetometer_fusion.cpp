#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/estimator/magnetometer/field/field_reading.h"
#include "lodeline/estimator/uncertainty/time_correlated_error.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {
namespace {

// Maximum length of a mean. A rig just switched on does not know its gyroscope bias, so readings are carried
// for a short time, if they suffice.
constexpr double kShortMean_s = 0.25;
constexpr double kLongMean_s = 1.0;
constexpr int kEnoughReadings = 3;
constexpr double kLongestWait_s = 5.0;  // of means until their window starts

MagnetometerUse useOf(const std::optional<MagnetometerCalibration>& magnetometer, MagnetometerUse wanted) {
  if (!magnetometer || wanted == MagnetometerUse::Off) return MagnetometerUse::Off;
  if (wanted != MagnetometerUse::Automatic) return wanted;
  return magnetometer->is_calibrated ? MagnetometerUse::Absolute : MagnetometerUse::Off;
}

/// The readings that enter a mean: within the IMU's readings and not too old.
std::span<const FieldSample> recent(std::span<const FieldSample> samples, std::span<const ImuSample> imu) {
  const auto since = [&](Time begin) {
    return samples.subspan(static_cast<size_t>(std::count_if(
        samples.begin(), samples.end(), [&](const FieldSample& sample) { return sample.time < begin; })));
  };
  const Time end = imu.back().time;
  while (!samples.empty() && samples.back().time > end) samples = samples.first(samples.size() - 1);
  const auto last = since(std::max(imu.front().time, end - Duration::fromSeconds(kShortMean_s)));
  if (static_cast<int>(last.size()) >= kEnoughReadings) return last;
  return since(std::max(imu.front().time, end - Duration::fromSeconds(kLongMean_s)));
}

}  // namespace

MagnetometerFusion::MagnetometerFusion(const Rig& rig, const EstimatorOptions& options,
                                       Diagnostics* diagnostics)
    : options_(options),
      diagnostics_(diagnostics),
      use_(useOf(rig.magnetometer, options.magnetometer.use)),
      calibration_(rig.magnetometer.value_or(MagnetometerCalibration())),
      gyroscope_density_(options.preintegration.noise_inflation *
                         rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz),
      readings_(calibration_, diagnostics),
      comparison_(options.magnetometer),
      gate_(options.magnetometer.gate),
      errors_(options.magnetometer, offsetSigma()),
      deviation_(options.magnetometer),
      step_(options.magnetometer.step),
      map_(options.magnetometer.map, diagnostics),
      currents_(rig, diagnostics) {
  if (!rig.magnetometer || calibration_.is_calibrated || options.magnetometer.use == MagnetometerUse::Off)
    return;
  if (use_ == MagnetometerUse::Off) {
    status_ = MagnetometerStatus::Uncalibrated;
    diagnostics->report(
        Severity::Warning, "magnetometer_uncalibrated",
        "magnetometer: not calibrated, hence not used; `lodeline calibrate magnetometer` makes "
        "a calibration for --mag-calibration, and --magnetometer absolute uses it as it is");
  } else {
    diagnostics->report(
        Severity::Warning, "magnetometer_uncalibrated",
        "magnetometer: used without a calibration; heading may be wrong by tens of degrees until "
        "the rig has turned");
  }
}

void MagnetometerFusion::take(const SensorReadings& readings, std::span<const ImuSample> imu,
                              const Vec3& gyroscope_bias_B) {
  // Faults are reported even when the magnetometer is not used, because the attitude filter beside the
  // odometry may use it.
  const std::vector<FieldSample> fields = readings_.add(readings.of<MagnetometerSample>());
  if (use_ == MagnetometerUse::Off || imu.empty()) return;
  const std::span<const FieldSample> samples = recent(fields, imu);
  const Time time = imu.back().time;
  std::erase_if(means_, [&](const auto& entry) { return (time - entry.first).seconds() > kLongestWait_s; });
  if (currents_.isOnBoard()) currents_.add(readings.of<CurrentSample>());
  if (!samples.empty()) keepMean(samples, imu, gyroscope_bias_B);
}

void MagnetometerFusion::start(double tilt_sigma_rad, Window* window, Prior* prior) {
  if (use_ == MagnetometerUse::Off) return;
  tilt_variance_rad2_ = tilt_sigma_rad * tilt_sigma_rad;
  started_ = window->newest().time;
  status_ = MagnetometerStatus::NoData;
  align(window, prior);
  for (const auto& frame : window->frames()) {
    const auto mean = means_.find(frame->time);
    if (mean == means_.end()) continue;
    frame->measurements.set(measurementOf(mean->second, 1.0, false));
    status_ = MagnetometerStatus::Used;
  }
  means_.clear();
}

double MagnetometerFusion::offsetSigma() const {
  return lodeline::offsetSigma(calibration_, options_.magnetometer);
}

double MagnetometerFusion::floorSigma(const Vec3& field_B) const {
  return std::hypot(deviation_.sigma_T(errors_.correlated_noise_sigma_T()),
                    calibration_.rotation_sigma_rad.value_or(0.0) * field_B.norm());
}

void MagnetometerFusion::addStates(const HeadingAlignment& alignment, Window* window, Prior* prior) const {
  const MagnetometerOptions& wanted = options_.magnetometer;
  const auto add = [&](const char* name, const Vec3& value, double walk) -> ParameterBlock& {
    return window->add({name, {value.x(), value.y(), value.z()}, std::nullopt, walk, true});
  };
  ParameterBlock& field = add(MagnetometerStates::kField, alignment.field_W, 0.0);
  ParameterBlock& offset = add(MagnetometerStates::kOffset, Vec3::Zero(), wanted.offset_walk_T_per_sqrt_s);
  add(MagnetometerStates::kDisturbance, Vec3::Zero(), wanted.disturbance_walk_T_per_sqrt_s);
  prior->append(field.value.data(), 3, Vec3::Constant(wanted.field_sigma_T));
  prior->append(offset.value.data(), 3, Vec3::Constant(offsetSigma()));
  for (ParameterBlock& state : currents_.states()) {
    ParameterBlock& field_of_current = window->add(std::move(state));
    prior->append(field_of_current.value.data(), 3, CurrentCompensation::stateSigmas());
  }
}

double MagnetometerFusion::whiteVariance(const FrameField& field) const {
  const double density = options_.magnetometer.noise_inflation * calibration_.noise_density_T_per_sqrtHz;
  const double variance_T2 = density * density * calibration_.rate_hz / field.mean.readings;
  return currents_.isOnBoard() ? variance_T2 + currents_.noiseVariance_T2(field.currents) : variance_T2;
}

void MagnetometerFusion::remember(const JointCovariance& covariance, Window& window) {
  covariance_ = covariance;
  map_.remember(covariance, window);
  tilt_variance_rad2_ = 0.5 * covariance_.newest().diagonal().segment<2>(3).sum();
}

TimeCorrelatedError MagnetometerFusion::tiltError() const {
  const double longest_s = options_.magnetometer.correlated_noise_time_s;
  const double growth_rad2_per_s = gyroscope_density_ * gyroscope_density_;
  return {tilt_variance_rad2_, tilt_variance_rad2_ < longest_s * growth_rad2_per_s
                                   ? tilt_variance_rad2_ / growth_rad2_per_s
                                   : longest_s};
}

double MagnetometerFusion::tiltSigma(Time now) {
  const double shared = timeCorrelatedShare(now, last_seen_, tiltError().correlation_s);
  // An error of the tilt is correlated over time as well, but information gained since the last frame is
  // independent. The tilt error of the frames so far must lose weight. The weighted mean of the errors of an
  // estimate with growing information has twice the variance of the last error, hence the factor 0.5.
  const double information = 1.0 / tilt_variance_rad2_;
  const bool is_first = least_tilt_variance_rad2_ == 0.0;
  const double known = is_first ? information : 1.0 / least_tilt_variance_rad2_;
  const double learned = 0.5 * std::max(0.0, information - known);
  least_tilt_variance_rad2_ = 1.0 / std::max(information, known);
  return 1.0 / std::sqrt(information / shared + learned);
}

FieldMeasurement MagnetometerFusion::measurementOf(const FrameField& field, double variance_scale,
                                                   bool disturbed) {
  const MagnetometerOptions& wanted = options_.magnetometer;
  const MagnetometerMean& mean = field.mean;
  FieldMeasurement measurement;
  measurement.mean = mean;
  measurement.relative = !absolute();
  measurement.disturbed = disturbed;
  if (measurement.relative) {
    measurement.mean = withoutCurrents(field, nullptr);
    measurement.noise.sigma_T = std::sqrt(whiteVariance(field) * mean.readings);
    return measurement;
  }
  if (currents_.isOnBoard() && currents_.areStates()) {
    measurement.currents_A.assign(field.currents.currents_A.begin(), field.currents.currents_A.end());
  } else {
    measurement.mean = withoutCurrents(field, nullptr);
  }
  const double shared = timeCorrelatedShare(mean.time, last_seen_, wanted.correlated_noise_time_s);
  const double variance_T2 = whiteVariance(field) + shared * std::pow(floorSigma(mean.field_B), 2);
  measurement.noise.sigma_T = std::sqrt(variance_scale * variance_T2);
  measurement.noise.rotation_sigma_rad = mean.rotation_sigma_rad * std::sqrt(variance_scale);
  measurement.noise.tilt_sigma_rad = tiltSigma(mean.time) * std::sqrt(variance_scale);
  last_seen_ = mean.time;
  return measurement;
}

void MagnetometerFusion::addToNewest(Window& window, Marginalizer& marginalizer) {
  if (use_ == MagnetometerUse::Off) return;
  map_.learnSettled(window);
  Frame& newest = window.newest();
  const auto found = means_.find(newest.time);
  status_ = MagnetometerStatus::NoData;
  if (found == means_.end()) {
    missField(window);
    return;
  }
  const FrameField field = found->second;
  means_.clear();
  if (!absolute()) {
    findNorth(newest.worldFromBody().rotation * withoutCurrents(field, nullptr).field_B, newest.time);
    status_ = MagnetometerStatus::Used;
    newest.measurements.set(measurementOf(field, 1.0, false));
    return;
  }
  if (MagnetometerStates(window).field == nullptr) startLate(field, window, marginalizer);
  findNorth(MagnetometerStates(window).field_W(), newest.time);
  if (currents_.isOnBoard()) checkCurrents(field, window);
  judge(withoutSteps(field, window), window, marginalizer);
  if (takeBetterField(field, window, marginalizer)) status_ = MagnetometerStatus::Used;
}

MagnetometerFusion::FrameField MagnetometerFusion::withoutSteps(const FrameField& field, Window& window) {
  if (!options_.magnetometer.step.enabled) return field;
  const MagnetometerMean mean = withoutCurrents(field, &window);
  FrameField corrected = field;
  if (areCurrentsUncertain(field, window)) {
    corrected.mean.field_B -= mean.carried * step_.step_B();
    return corrected;
  }
  const MagnetometerStates states(window);
  const Quat body_from_world = window.newest().worldFromBody().rotation.conjugate();
  MagneticStepDetector::Reading reading;
  reading.time = mean.time;
  reading.difference_B = mean.field_B - body_from_world * states.field_W() - mean.carried * states.offset_B();
  reading.heading_B = body_from_world * Vec3::UnitZ().cross(states.field_W()).normalized();
  reading.white_variance_T2 = whiteVariance(field);
  reading.is_believed =
      status_before_ == MagnetometerStatus::Used || status_before_ == MagnetometerStatus::Off;
  if (const auto change = step_.add(reading)) {
    states.offset->sudden_variance += change->sigma_T * change->sigma_T;
    diagnostics_->report(
        Severity::Notice, "magnetometer_step",
        fmt::format("magnetometer: at {} ns the field on board changed at once by {:.2f} uT (a lamp or a "
                    "motor was switched); readings are corrected by it",
                    mean.time.nanoseconds(), 1e6 * change->by_B.norm()));
  }
  corrected.mean.field_B -= mean.carried * step_.step_B();
  return corrected;
}

void MagnetometerFusion::startLate(const FrameField& field, Window& window, Marginalizer& marginalizer) {
  HeadingAlignment alignment;
  alignment.field_W = window.newest().worldFromBody().rotation * withoutCurrents(field, nullptr).field_B;
  Prior states;
  addStates(alignment, &window, &states);
  const MagnetometerStates added(window);
  marginalizer.addKnowledge(*added.field, Vec3::Constant(options_.magnetometer.field_sigma_T));
  marginalizer.addKnowledge(*added.offset, Vec3::Constant(offsetSigma()));
  for (ParameterBlock* state : CurrentStates(window, currents_.states().size()).blocks)
    marginalizer.addKnowledge(*state, CurrentCompensation::stateSigmas());
}

void MagnetometerFusion::judge(const FrameField& field, Window& window, Marginalizer& marginalizer) {
  Frame& newest = window.newest();
  const MagnetometerMean mean = withoutCurrents(field, &window);
  std::vector<double> currents_A(field.currents.currents_A.begin(), field.currents.currents_A.end());
  comparison_.add(mean, whiteVariance(field), window, currents_A);
  const FieldCheck earth = comparison_.check(window, covariance_, errors_.correlated_noise_sigma_T(), false);
  std::optional<FieldCheck> with_disturbance;
  if (disturbed_)
    with_disturbance = comparison_.check(window, covariance_, errors_.correlated_noise_sigma_T(), true);
  const GateDecision decision = gate_.decide(mean.time, earth, with_disturbance);
  reportDecision(decision, mean.time);
  status_ = decision.status;
  if (decision.end_disturbance || (decision.begin_disturbance && disturbed_))
    endDisturbance(window, marginalizer);
  if (decision.begin_disturbance) beginDisturbance(mean, window, marginalizer);
  learnAnomaly(field, earth, window);
  if (!areCurrentsUncertain(field, window)) {
    FieldReading reading;
    reading.field_B = mean.field_B - mean.carried * MagnetometerStates(window).offset_B();
    reading.sigma_T = std::hypot(std::sqrt(whiteVariance(field)), errors_.correlated_noise_sigma_T());
    newest.measurements.set(reading);
  }
  // A rejected sensor (Inconsistent) is also evaluated; otherwise it could never be accepted again.
  if (status_ == MagnetometerStatus::Used || status_ == MagnetometerStatus::Inconsistent)
    learnErrors(field, mean, window);
  if (status_ != MagnetometerStatus::Used && takeByMap(field, mean, window)) return;
  if (!decision.use) {
    // A field that was rejected a moment ago is not independent information: its disturbance fades slowly.
    last_seen_ = mean.time;
    return;
  }
  const bool disturbed = status_ == MagnetometerStatus::Readmitted;
  newest.measurements.set(measurementOf(field, decision.variance_scale, disturbed));
}

void MagnetometerFusion::learnErrors(const FrameField& field, const MagnetometerMean& clean, Window& window) {
  if (areCurrentsUncertain(field, window)) return;
  const MagnetometerStates states(window);
  errors_.add(clean, window.newest().worldFromBody().rotation, states.offset_B(), whiteVariance(field),
              tiltError());
  states.offset->walk_per_sqrt_s = errors_.walk_T_per_sqrt_s();
}

void MagnetometerFusion::beginDisturbance(const MagnetometerMean& clean, Window& window,
                                          Marginalizer& marginalizer) {
  const MagnetometerStates states(window);
  const Vec3 measured_W =
      window.newest().worldFromBody().rotation * (clean.field_B - clean.carried * states.offset_B());
  const Vec3 disturbance_W = measured_W - states.field_W();
  std::copy_n(disturbance_W.data(), 3, states.disturbance->value.begin());
  marginalizer.addKnowledge(*states.disturbance, Vec3::Constant(options_.magnetometer.disturbance_sigma_T));
  disturbed_ = true;
}

void MagnetometerFusion::endDisturbance(Window& window, Marginalizer& marginalizer) {
  for (const auto& frame : window.frames()) {
    const auto* measured = frame->measurements.find<FieldMeasurement>();
    if (measured && measured->disturbed) frame->measurements.remove<FieldMeasurement>();
  }
  ParameterBlock& disturbance = *MagnetometerStates(window).disturbance;
  marginalizer.forget(window, disturbance);
  std::fill(disturbance.value.begin(), disturbance.value.end(), 0.0);
  disturbed_ = false;
}

void MagnetometerFusion::reportDecision(const GateDecision& decision, Time time) {
  const bool inconsistent = decision.status == MagnetometerStatus::Inconsistent;
  if (inconsistent && status_before_ != MagnetometerStatus::Inconsistent) {
    diagnostics_->report(
        Severity::Warning, "magnetometer_inconsistent",
        fmt::format(
            "magnetometer: its field has disagreed with its calibration for longer than it has agreed "
            "with it, up to {} ns; nothing of it is used from then on unless that changes. Calibrate it "
            "anew, where it is mounted (`lodeline calibrate magnetometer`)",
            time.nanoseconds()));
  }
  if (!decision.use && !inconsistent && !rejecting_) {
    diagnostics_->report(
        Severity::Warning, "magnetometer_rejected",
        fmt::format("magnetometer: not the Earth's field ({}) from {} ns on; heading is carried by gyroscope "
                    "and images",
                    toString(decision.status), time.nanoseconds()));
  }
  if (decision.begin_disturbance) {
    diagnostics_->report(
        Severity::Warning, "magnetometer_readmitted",
        fmt::format("magnetometer: its field at {} ns has been another for {:.0f} s; used from "
                    "now on with a disturbance that is estimated",
                    time.nanoseconds(), options_.magnetometer.gate.readmission_s));
  }
  rejecting_ = !decision.use;
  status_before_ = decision.status;
}

double MagnetometerFusion::axesSigma() const {
  if (!calibration_.is_calibrated) return options_.magnetometer.uncalibrated_axes_sigma;
  return options_.imu_axes.uncalibrated_sigma;
}

MagnetometerEstimate MagnetometerFusion::estimate(const Window& window) const {
  MagnetometerEstimate estimate;
  estimate.status = status_;
  describeNorth(window, &estimate);
  if (heading_reference_ == HeadingReference::True)
    estimate.declination_sigma_rad = options_.magnetometer.declination_sigma_rad;
  const MagnetometerStates states(window);
  if (states.field != nullptr) {
    const Vec3 field_W = states.field_W();
    estimate.axes_sigma_rad =
        std::min(std::numbers::pi, axesSigma() * field_W.norm() / field_W.head<2>().norm());
    estimate.field_W = field_W;
    estimate.offset_B = states.offset_B();
    estimate.correlated_noise_sigma_T = errors_.correlated_noise_sigma_T();
  }
  return estimate;
}

}  // namespace lodeline

#include "lodeline/estimator/trials/heading_trial.h"

#include <algorithm>
#include <cmath>

#include "lodeline/estimator/magnetometer/field/magnetic_noise_estimator.h"
#include "lodeline/estimator/trials/trial_disturbances.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/thread_clock.h"
#include "simulation/dive/point_dive.h"

namespace lodeline {
namespace {

const Vec3 kField_W = HeadingTrialOptions::field_W();

/// A lamp that burns for half of each interval; the first one begins at 6 % of the dive.
std::vector<SwitchedCurrent> switchedEvenly(const Vec3& field_B, const HeadingTrialOptions& options) {
  const double interval_s = 0.93 * options.duration_s / options.lamp_switchings;
  std::vector<SwitchedCurrent> switched;
  for (int i = 0; i < options.lamp_switchings; ++i)
    switched.push_back({0.06 * options.duration_s + interval_s * i, 0.5 * interval_s, field_B});
  return switched;
}

MagneticDisturbances disturbancesOf(const HeadingTrialOptions& options, const PointDive& dive) {
  const Motion& motion = dive.motion;
  DisturbanceOptions wanted;
  wanted.seed = options.seed;
  MagneticDisturbances drawn;
  switch (options.trouble) {
    case FieldTrouble::Disturbances:
      wanted.mean_interval_s = options.duration_s / 7.0;
      wanted.least_deflection_rad = 3.0 * kDegree;
      wanted.most_deflection_rad = 10.0 * kDegree;
      wanted.shortest_s = wanted.longest_s = 20.0;
      return drawDisturbances(motion, kField_W, wanted);
    case FieldTrouble::Tank:
      wanted.mean_interval_s = 0.5 * options.duration_s;
      wanted.least_deflection_rad = wanted.most_deflection_rad = 8.0 * kDegree;
      wanted.shortest_s = wanted.longest_s = 0.15 * options.duration_s;
      drawn = drawDisturbances(motion, kField_W, wanted);
      drawn.lying.clear();
      return drawn;
    case FieldTrouble::Dipole:
      wanted.mean_interval_s = options.duration_s / 8.0;
      wanted.least_deflection_rad = wanted.most_deflection_rad = 15.0 * kDegree;
      drawn = drawDisturbances(motion, kField_W, wanted);
      drawn.passing.clear();
      return drawn;
    case FieldTrouble::Boat: {
      const Vec3 boat_W(12e-6, -4e-6, 3e-6);
      drawn.wandering = {10.0, {boat_W, boat_W, boat_W, boat_W, Vec3::Zero()}};
      return drawn;
    }
    case FieldTrouble::Lamp:
      drawn.switched = drawLampSwitching(options.duration_s, options.seed, options.lamp_earliest_s);
      if (options.lamp_switchings > 0 && !drawn.switched.empty())
        drawn.switched = switchedEvenly(drawn.switched.front().field_B, options);
      return drawn;
    case FieldTrouble::Beside:
      drawn.lying = drawDipolesBeside(motion, kField_W, 8.0, options.seed);
      return drawn;
    case FieldTrouble::AtStart:
      drawn.lying = drawIronAtStart(motion, kField_W, options.seed);
      return drawn;
    case FieldTrouble::Magnetite:
      drawn.lying = drawMagnetite(dive.passage, kField_W, options.seed);
      return drawn;
    case FieldTrouble::Together: {
      drawn.lying = drawIronAtStart(motion, kField_W, options.seed);
      drawn.steel = drawMagnetite(dive.passage, kField_W, options.seed);
      const auto beside = drawDipolesBeside(motion, kField_W, 8.0, options.seed);
      drawn.lying.insert(drawn.lying.end(), beside.begin(), beside.end());
      return drawn;
    }
    default:
      return drawn;
  }
}

/// Draws a value from the log-normal distribution that MagneticNoiseEstimator assumes.
double drawSize(double root_mean_square, Random& random) {
  const double spread = std::log(MagneticNoiseEstimator::kPriorFactor);
  return root_mean_square * std::exp(spread * (random.normal() - spread));
}

/// Draws the hard iron's walk and the wandering field of a dive.
void drawAsBelieved(const HeadingTrialOptions& options, PointMagnetometer* magnetometer) {
  const MagnetometerOptions& believed = options.estimator.magnetometer;
  Random random(options.seed, "heading trial/as believed");
  magnetometer->errors.hard_iron_walk_T_per_sqrt_s = drawSize(believed.offset_walk_T_per_sqrt_s, random);
  magnetometer->disturbances.wandering =
      drawWanderingField(options.duration_s, drawSize(believed.correlated_noise_sigma_T, random),
                         believed.correlated_noise_time_s, options.seed);
}

/// Adds the option's errors to the calibration.
void spoil(const HeadingTrialOptions& options, Random& random, MagnetometerCalibration* calibration) {
  const Vec3 direction = random.direction();
  Mat3& iron = calibration->iron_correction;
  switch (options.trouble) {
    case FieldTrouble::AsBelieved:
      calibration->hard_iron_T += std::hypot(options.estimator.magnetometer.offset_sigma_T,
                                             calibration->hard_iron_sigma_T.value_or(0.0)) *
                                  random.normal3();
      return;
    case FieldTrouble::HardIron:
      calibration->hard_iron_T += 0.3e-6 * direction;
      return;
    case FieldTrouble::Calibration:
      calibration->hard_iron_T += 8e-6 * direction;
      iron = Mat3::Identity();
      return;
    case FieldTrouble::SoftIron:
      iron *= Mat3::Identity() + 0.1 * (3.0 * direction * direction.transpose() - Mat3::Identity()) / 2.0;
      return;
    case FieldTrouble::Misalignment:
      iron = so3::exp(20.0 * kDegree * direction) * iron;
      return;
    case FieldTrouble::Scale:
      iron *= 1.5;
      return;
    case FieldTrouble::SwappedAxes:
      iron.row(0).swap(iron.row(1));
      return;
    default:
      return;
  }
}

/// Sets the rig's calibration for a magnetometer with these errors.
void calibrate(const MagnetometerErrors& errors, const HeadingTrialOptions& options,
               MagnetometerCalibration* calibration) {
  Random random(options.seed, "heading trial/calibration");
  calibration->noise_density_T_per_sqrtHz = errors.noise_density_T_per_sqrtHz;
  calibration->body_from_magnetometer = errors.body_from_magnetometer;
  calibration->iron_correction = errors.soft_iron.inverse();
  calibration->hard_iron_T = errors.hard_iron_T;
  calibration->is_calibrated = true;
  calibration->hard_iron_sigma_T = 0.01e-6;  // as stated after a calibration with a figure of eight
  spoil(options, random, calibration);
  if (options.spoil) options.spoil(calibration);
}

PointDive diveOf(const HeadingTrialOptions& options, const ImuErrors& imu) {
  DiveMotionOptions motion;
  motion.seed = options.seed;
  motion.duration_s = options.duration_s;
  motion.path_length_m = 0.25 * options.duration_s;
  StandardRigOptions rig;
  rig.cameras = options.cameras;
  return makePointDive(motion, standardRig(rig), imu);
}

EstimatorOptions estimatorOptions(const HeadingTrialOptions& options) {
  EstimatorOptions estimator = options.estimator;
  if (!options.honest_imu) return estimator;
  const ImuGrade& grade = imuGrade(options.imu_grade);
  estimator.preintegration.noise_inflation = 1.0;
  estimator.preintegration.motion_noise = MotionNoiseOptions::none();
  estimator.imu_axes.gyroscope_sigma = estimator.imu_axes.accelerometer_sigma = 0.0;
  estimator.initial_state.gyroscope_bias_sigma_rad_per_s = std::max(1e-3, grade.gyroscope_turn_on_rad_per_s);
  estimator.initial_state.accelerometer_bias_sigma_m_per_s2 =
      std::max(1e-2, grade.accelerometer_turn_on_m_per_s2);
  return estimator;
}

/// Readings of a frame, those of the magnetometer with the field of currents.
SensorReadings readingsOf(const SimulatedFrame& frame, Time start,
                          const std::optional<TrialCurrents>& currents, const Rig& rig) {
  if (!currents) return SensorReadings(frame.magnetometer);
  std::vector<MagnetometerSample> fields = frame.magnetometer;
  for (MagnetometerSample& sample : fields)
    sample.field_M += currents->field_M((sample.time - start).seconds());
  if (!rig.currents) return SensorReadings(std::move(fields));
  const double begin_s = (frame.imu.front().time - start).seconds(),
               end_s = (frame.imu.back().time - start).seconds();
  return SensorReadings(std::move(fields), currents->readings(start, begin_s, end_s));
}

double wrapped(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

template <typename Figure>
double rootMeanSquare(const std::vector<HeadingSample>& samples, double begin_s, const Figure& figure) {
  double squares = 0.0;
  int count = 0;
  for (const HeadingSample& sample : samples) {
    if (sample.time_s < begin_s) continue;
    squares += std::pow(figure(sample), 2);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : std::nan("");
}

}  // namespace

const char* toString(FieldTrouble trouble) {
  constexpr std::array kNames = {"none",         "hard iron", "disturbances", "tank",       "dipole",
                                 "calibration",  "lamp",      "soft iron",    "misaligned", "scale",
                                 "swapped axes", "boat",      "as believed",  "beside",     "at start",
                                 "magnetite",    "together"};
  return kNames[static_cast<size_t>(trouble)];
}

double HeadingTrial::rms(double begin_s) const {
  return rootMeanSquare(samples, begin_s, [](const HeadingSample& s) { return s.error_rad; });
}

double HeadingTrial::claimed(double begin_s) const {
  return rootMeanSquare(samples, begin_s, [](const HeadingSample& s) { return s.sigma_rad; });
}

double HeadingTrial::finishedRms(double begin_s) const {
  return rootMeanSquare(samples, begin_s, [](const HeadingSample& s) { return s.finished_error_rad; });
}

double HeadingTrial::largest(double begin_s) const {
  double largest = 0.0;
  for (const HeadingSample& sample : samples) {
    if (sample.time_s >= begin_s) largest = std::max(largest, std::abs(sample.error_rad));
  }
  return largest;
}

double HeadingTrial::alignedRms(double begin_s) const {
  double sum = 0.0;
  int count = 0;
  for (const HeadingSample& sample : samples) {
    if (sample.time_s < begin_s) continue;
    sum += sample.finished_error_rad;
    ++count;
  }
  const double mean = count > 0 ? sum / count : 0.0;
  return rootMeanSquare(samples, begin_s,
                        [mean](const HeadingSample& s) { return s.finished_error_rad - mean; });
}

double HeadingTrial::share(MagnetometerStatus status) const {
  const auto count = std::count_if(samples.begin(), samples.end(),
                                   [status](const HeadingSample& sample) { return sample.status == status; });
  return samples.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(samples.size());
}

double runTrialDive(const HeadingTrialOptions& options, const TrialObserver& observe,
                    Diagnostics* diagnostics) {
  SpecimenOptions specimen;
  ImuErrors imu = drawImuErrors(imuGrade(options.imu_grade), specimen, options.seed);
  if (!options.bias_instability) imu.gyroscope.bias_instability = imu.accelerometer.bias_instability = 0.0;
  PointDive dive = diveOf(options, imu);
  PointMagnetometer magnetometer;
  magnetometer.field_W = kField_W;
  magnetometer.errors = drawMagnetometerErrors(options.imu_grade, {}, options.seed);
  magnetometer.disturbances = disturbancesOf(options, dive);
  if (options.trouble == FieldTrouble::AsBelieved) drawAsBelieved(options, &magnetometer);
  calibrate(magnetometer.errors, options, &*dive.mounted.rig.magnetometer);

  PointSimulationOptions points;
  points.seed = options.seed;
  points.frame_rate_hz = options.frame_rate_hz;
  points.tracks = options.tracks;
  points.imu = imu;
  points.magnetometer = magnetometer;
  PointSimulation simulation = dive.simulate(points);

  std::optional<TrialCurrents> currents;
  if (options.currents) currents.emplace(*options.currents, options.duration_s, options.seed);
  if (currents && options.currents->has_sensor) dive.mounted.rig.currents = currents->calibration();

  Diagnostics unseen;
  Estimator estimator(dive.mounted.rig, estimatorOptions(options), diagnostics ? diagnostics : &unseen);
  double estimator_s = 0.0;
  std::optional<Time> first;
  while (auto frame = simulation.next()) {
    if (!first) first = frame->truth.time;
    const double time_s = (frame->truth.time - *first).seconds();
    const bool is_silent = options.magnetometer_pause && options.magnetometer_pause->contains(time_s);
    if (time_s < options.magnetometer_from_s || is_silent) frame->magnetometer.clear();
    const SensorReadings readings = readingsOf(*frame, points.start, currents, dive.mounted.rig);
    const double before_s = threadSeconds();
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu, readings);
    estimator_s += threadSeconds() - before_s;
    observe(*frame, estimate, estimator);
  }
  return estimator_s;
}

HeadingTrial runHeadingTrial(const HeadingTrialOptions& options) {
  HeadingTrial trial;
  std::optional<double> first_rad;
  std::vector<double> headings_rad;  // of the estimator's world relative to the true world
  double north_rad = 0.0;
  const Time begin = PointSimulationOptions().start;
  const auto observe = [&](const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator&) {
    if (estimate.status == Status::Waiting) return;
    const Quat& estimated = estimate.state.world_from_body.rotation;
    const Quat& truth = frame.truth.motion.world_from_body.rotation;
    const MagnetometerEstimate& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
    trial.reference = magnetometer.heading_reference;
    for (const SensorRow& row : estimate.sensor_rows) {
      if (row.sensor == "currents") ++trial.current_status[row.status];
    }
    trial.correlated_noise_sigma_T = magnetometer.correlated_noise_sigma_T.value_or(0.0);
    headings_rad.push_back(so3::log(estimated * truth.conjugate()).z());
    if (!first_rad) first_rad = headings_rad.back();
    north_rad = magnetometer.north_from_world_rad.value_or(-*first_rad);
    const double sigma_rad = magnetometer.status == MagnetometerStatus::Off
                                 ? std::sqrt(estimate.covariance(5, 5))
                                 : magnetometer.heading_sigma_rad;
    trial.samples.push_back({(frame.truth.time - begin).seconds(), wrapped(headings_rad.back() + north_rad),
                             sigma_rad, 0.0, magnetometer.status});
  };
  trial.estimator_s = runTrialDive(options, observe, &trial.findings);
  for (size_t i = 0; i < headings_rad.size(); ++i)
    trial.samples[i].finished_error_rad = wrapped(headings_rad[i] + north_rad);
  return trial;
}

}  // namespace lodeline

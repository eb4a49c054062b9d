#include "lodeline/estimator/trials/disturbed_dive.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"
#include "simulation/dive/point_dive.h"
#include "simulation/sensors/landmarks_along.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

/// Estimates and truth of a run, frame by frame.
class RunErrors {
 public:
  RunErrors(const Vec3& field_W, bool knows_site, Time begin) : begin_(begin) {
    MagnetometerOptions options;
    if (knows_site) options.site_field_W = field_W;
    north_of_truth_rad_ = knows_site ? 0.0 : northFromWorld(field_W, HeadingReference::Magnetic, options);
  }

  void add(const SimulatedFrame& frame, const FrameEstimate& estimate) {
    const Rigid3& truth = frame.truth.motion.world_from_body;
    if (last_W_) path_m_ += (truth.translation - *last_W_).norm();
    last_W_ = truth.translation;
    if (estimate.status == Status::Waiting) return;
    const MagnetometerEstimate& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
    const Quat& estimated = estimate.state.world_from_body.rotation;
    turns_rad_.push_back(so3::log(estimated * truth.rotation.conjugate()).z());
    estimated_W_.push_back(estimate.state.world_from_body.translation);
    true_W_.push_back(truth.translation);
    const bool has_north = magnetometer.north_from_world_rad.has_value();
    const double north_rad =
        has_north ? *magnetometer.north_from_world_rad - north_of_truth_rad_ : -turns_rad_.front();
    const double sigma_rad =
        has_north ? magnetometer.heading_sigma_rad : std::sqrt(estimate.covariance(5, 5));
    samples_.push_back({(frame.truth.time - begin_).seconds(),
                        std::remainder(turns_rad_.back() + north_rad, 2.0 * std::numbers::pi), sigma_rad, 0.0,
                        magnetometer.status});
  }

  DisturbedRun result() {
    DisturbedRun run;
    DiveErrorsOfRun& errors = run.errors;
    const double count = static_cast<double>(samples_.size());
    errors.path_m = path_m_;
    errors.heading_rms_rad = headingRmsFrom(0.0);
    errors.settled_rms_rad = headingRmsFrom(kSettled_s);
    errors.position_rms_m = alignedPositionRms();
    double end_sum_rad = 0.0;
    int at_end = 0;
    for (const HeadingSample& sample : samples_) {
      const double sigmas = std::abs(sample.error_rad) / sample.sigma_rad;
      errors.north_rms_rad += sample.error_rad * sample.error_rad / count;
      errors.claimed_rad += sample.sigma_rad * sample.sigma_rad / count;
      errors.within_3_sigmas += (sigmas <= 3.0) / count;
      errors.most_sigmas = std::max(errors.most_sigmas, sigmas);
      errors.used_share += (sample.status == MagnetometerStatus::Used) / count;
      errors.readmitted_share += (sample.status == MagnetometerStatus::Readmitted) / count;
      if (sample.time_s < samples_.back().time_s - 10.0) continue;
      end_sum_rad += sample.error_rad;
      ++at_end;
    }
    errors.north_rms_rad = std::sqrt(errors.north_rms_rad);
    errors.claimed_rad = std::sqrt(errors.claimed_rad);
    errors.north_end_rad = end_sum_rad / at_end;
    run.samples = std::move(samples_);
    return run;
  }

 private:
  /// Root mean square of the heading errors about their mean, of the frames from `begin_s` on.
  double headingRmsFrom(double begin_s) const {
    std::vector<double> turns_rad;
    double cosines = 0.0, sines = 0.0;
    for (size_t i = 0; i < turns_rad_.size(); ++i) {
      if (samples_[i].time_s < begin_s) continue;
      turns_rad.push_back(turns_rad_[i]);
      cosines += std::cos(turns_rad_[i]);
      sines += std::sin(turns_rad_[i]);
    }
    const double mean_rad = std::atan2(sines, cosines);
    double squares = 0.0;
    for (const double turn_rad : turns_rad)
      squares += std::pow(std::remainder(turn_rad - mean_rad, 2.0 * std::numbers::pi), 2);
    return std::sqrt(squares / static_cast<double>(turns_rad.size()));
  }

  double alignedPositionRms() const {
    Vec3 mean_estimated_W = Vec3::Zero(), mean_true_W = Vec3::Zero();
    const double count = static_cast<double>(true_W_.size());
    for (size_t i = 0; i < true_W_.size(); ++i) {
      mean_estimated_W += estimated_W_[i] / count;
      mean_true_W += true_W_[i] / count;
    }
    double cosine = 0.0, sine = 0.0;
    for (size_t i = 0; i < true_W_.size(); ++i) {
      const Vec3 a = estimated_W_[i] - mean_estimated_W, b = true_W_[i] - mean_true_W;
      cosine += a.head<2>().dot(b.head<2>());
      sine += a.x() * b.y() - a.y() * b.x();
    }
    const Quat turn = so3::exp(std::atan2(sine, cosine) * Vec3::UnitZ());
    double squares = 0.0;
    for (size_t i = 0; i < true_W_.size(); ++i)
      squares += (turn * (estimated_W_[i] - mean_estimated_W) - (true_W_[i] - mean_true_W)).squaredNorm();
    return std::sqrt(squares / count);
  }

  Time begin_;
  double north_of_truth_rad_ = 0.0;  ///< azimuth that the world of the truth has in one that points north
  std::vector<HeadingSample> samples_;
  std::vector<double> turns_rad_;
  std::vector<Vec3> estimated_W_, true_W_;
  std::optional<Vec3> last_W_;
  double path_m_ = 0.0;
};

constexpr double kFrameRate_hz = 4.0;

int tracksOf(const DisturbedDive& dive) { return dive.cameras == 1 || dive.is_wreck ? 45 : 30; }

/// Residual errors of a calibration, as large as it states.
void spoilWithinClaim(uint64_t seed, MagnetometerCalibration* calibration) {
  Random random(seed, "disturbed dive/calibration");
  calibration->is_calibrated = true;
  calibration->hard_iron_sigma_T = 0.05e-6;
  calibration->rotation_sigma_rad = 0.1 * kDegree;
  calibration->hard_iron_T += 0.05e-6 * random.normal3();
  Quat& rotation = calibration->body_from_magnetometer.rotation;
  rotation = rotation * so3::exp(0.1 * kDegree * random.normal3());
}

void runWreck(const DisturbedDive& dive, const EstimatorOptions& wanted, DisturbedRun* run) {
  ScenarioChanges changes;
  changes.seed = dive.seed;
  changes.cameras = dive.cameras;
  changes.imu_grade = dive.imu_grade;
  changes.laps = 1;
  changes.effects = {"steel=" + std::string(dive.trouble == FieldTrouble::None ? "off" : "on")};
  VehicleDive vehicle = makeVehicleDive(makeScenario("wreck", changes));
  // Most of the way has no part of the hull in view, and no DVL helps here.
  vehicle.landmarks = landmarksAlong(vehicle.dive.motion, dive.seed);
  Rig rig = vehicle.givenRig();
  rig.dvl.reset();
  rig.altimeter.reset();
  rig.currents.reset();
  rig.magnetometer->iron_correction = vehicle.dive.errors.magnetometer.soft_iron.inverse();
  rig.magnetometer->hard_iron_T = vehicle.dive.errors.magnetometer.hard_iron_T;
  spoilWithinClaim(dive.seed, &*rig.magnetometer);
  EstimatorOptions options = wanted;
  if (dive.knows_site) options.magnetometer.site_field_W = vehicle.dive.field_W;
  PointSimulationOptions points = vehicle.options;
  points.frame_rate_hz = kFrameRate_hz;
  points.tracks = tracksOf(dive);
  points.vehicle.reset();
  PointSimulation simulation = vehicle.simulate(points);
  Estimator estimator(rig, options, &run->findings);
  RunErrors errors(vehicle.dive.field_W, dive.knows_site, points.start);
  while (const auto frame = simulation.next())
    errors.add(*frame, estimator.add(frame->tracks, frame->imu, SensorReadings(frame->magnetometer)));
  Diagnostics findings = std::move(run->findings);
  *run = errors.result();
  run->findings = std::move(findings);
}

void runCave(const DisturbedDive& dive, const EstimatorOptions& wanted, DisturbedRun* run) {
  HeadingTrialOptions options;
  options.seed = dive.seed;
  options.duration_s = dive.duration_s;
  options.frame_rate_hz = kFrameRate_hz;
  options.tracks = tracksOf(dive);
  options.cameras = dive.cameras;
  options.imu_grade = dive.imu_grade;
  options.trouble = dive.trouble;
  options.spoil = [seed = dive.seed](MagnetometerCalibration* c) { spoilWithinClaim(seed, c); };
  options.estimator = wanted;
  if (dive.knows_site) options.estimator.magnetometer.site_field_W = HeadingTrialOptions::field_W();
  RunErrors errors(HeadingTrialOptions::field_W(), dive.knows_site, PointSimulationOptions().start);
  Diagnostics findings;
  runTrialDive(
      options,
      [&](const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator&) {
        errors.add(frame, estimate);
      },
      &findings);
  *run = errors.result();
  run->findings = std::move(findings);
}

}  // namespace

std::vector<DisturbedDive> disturbedDives() {
  std::vector<DisturbedDive> dives;
  const auto add = [&](const char* what, FieldTrouble trouble, bool is_wreck) {
    for (int i = 0; i < 4; ++i) {
      DisturbedDive dive;
      dive.trouble = trouble;
      dive.is_wreck = is_wreck;
      dive.seed = 1 + dives.size();
      dive.cameras = i % 2 == 0 ? 2 : 1;
      dive.knows_site = i >= 2;
      dive.imu_grade = is_wreck || i == 1 || i == 2 ? "consumer" : "gx5-25";
      dive.name = fmt::format("{}, {}{}", what, dive.cameras == 2 ? "stereo" : "mono",
                              dive.knows_site ? ", site" : "");
      dives.push_back(dive);
    }
  };
  add("iron beside the way", FieldTrouble::Beside, false);
  add("iron at the start", FieldTrouble::AtStart, false);
  add("magnetite", FieldTrouble::Magnetite, false);
  add("all of these", FieldTrouble::Together, false);
  add("wreck", FieldTrouble::AtStart, true);
  return dives;
}

std::vector<DisturbedDive> undisturbedDives() {
  std::vector<DisturbedDive> dives;
  for (int i = 0; i < 6; ++i) {
    DisturbedDive dive;
    dive.seed = 31 + dives.size();
    dive.cameras = i % 2 == 0 ? 2 : 1;
    dive.knows_site = i % 4 >= 2;
    dive.imu_grade = i >= 2 ? "consumer" : "gx5-25";
    dive.is_wreck = i >= 4;
    dive.name =
        fmt::format("{}, {}, {}{}", dive.is_wreck ? "hull without steel" : "cave",
                    dive.cameras == 2 ? "stereo" : "mono", dive.imu_grade, dive.knows_site ? ", site" : "");
    dives.push_back(dive);
  }
  return dives;
}

DisturbedRun runDisturbedDive(const DisturbedDive& dive, MagnetometerUse use,
                              const EstimatorOptions& estimator) {
  EstimatorOptions options = estimator;
  options.magnetometer.use = use;
  DisturbedRun run;
  (dive.is_wreck ? runWreck : runCave)(dive, options, &run);
  return run;
}

}  // namespace lodeline

#include "lodeline/estimator/dvl/dvl_fusion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodeline/estimator/dvl/dvl_states.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr double kHeld = 1e-7;  // sigma of a state that is held: small enough, and well conditioned

}  // namespace

const char* toString(DvlStatus status) {
  switch (status) {
    case DvlStatus::Off:
      return "off";
    case DvlStatus::NoData:
      return "no_data";
    case DvlStatus::Invalid:
      return "invalid";
    case DvlStatus::Waiting:
      return "waiting";
    case DvlStatus::Rejected:
      return "rejected";
    case DvlStatus::WaterTrack:
      return "water_track";
    case DvlStatus::Used:
      return "used";
    case DvlStatus::Readmitted:
      return "readmitted";
  }
  return "";
}

DvlFusion::DvlFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : options_(options.dvl),
      diagnostics_(diagnostics),
      gravity_W_(options.gravity_W),
      integrator_(rig.imu, options.preintegration),
      trust_(options.dvl.readmission_s) {
  if (!options_.use || !rig.dvl) return;
  dvl_ = rig.dvl;
  const double rate_sigma_rad_per_s = options.preintegration.noise_inflation *
                                      rig.imu.noise.gyroscope_density_rad_per_s_sqrtHz *
                                      std::sqrt(std::max(rig.imu.rate_hz, 1.0));
  arm_sigma_m_per_s_ = rate_sigma_rad_per_s * dvl_->body_from_dvl.translation.norm();
  estimate_.status = DvlStatus::NoData;
}

void DvlFusion::take(const SensorReadings& readings, std::span<const ImuSample> imu, const Vec3&) {
  if (!dvl_) return;
  taken_ = DvlStatus::NoData;
  integrator_.add(imu);
  for (const DvlSample& sample : readings.of<DvlSample>()) {
    DvlReading reading = readRows(sample, *dvl_);
    reportTaken(sample, reading);
    if (!reading.rows.empty()) waiting_.push_back(std::move(reading));
  }
  // Before the start nobody asks for them.
  if (imu.empty()) return;
  const Time oldest = imu.back().time - Duration::fromSeconds(PingIntegrator::kLongest_s);
  std::erase_if(waiting_, [&](const DvlReading& reading) { return reading.time < oldest; });
}

void DvlFusion::reportTaken(const DvlSample& sample, const DvlReading& reading) {
  if (!reading.fault.empty()) {
    taken_ = std::max(taken_, DvlStatus::Invalid);
    diagnostics_->report(
        Severity::Warning, "dvl_invalid",
        fmt::format("DVL: at {} ns it gives {}, which no instrument measures; left out. Check the unit of "
                    "its velocities, and which values its driver writes for a lost lock",
                    sample.time.nanoseconds(), reading.fault));
  }
  if (sample.track == DvlTrack::Bottom || reading.rows.empty()) return;
  diagnostics_->report(
      Severity::Notice, "dvl_water_track",
      fmt::format("DVL: at {} ns the velocity is that through the water, whose own current is estimated; the "
                  "position drifts with each change of the current that nothing else measures",
                  sample.time.nanoseconds()));
}

std::vector<std::pair<Time, DvlPing>> DvlFusion::pingsUntil(const NavigationState& frame) {
  std::vector<std::pair<Time, DvlPing>> pings;
  std::erase_if(waiting_, [&](const DvlReading& reading) {
    if (reading.time > frame.time) return false;
    const std::optional<PingMotion> motion = integrator_.motion(reading.time, frame);
    if (!motion) return true;
    DvlPing ping;
    ping.geometry = {dvl_->body_from_dvl, gravity_W_, *motion, reading.track};
    ping.rows = reading.rows;
    ping.is_velocity = reading.is_velocity;
    ping.sigma_m_per_s = std::hypot(options_.noise_inflation * reading.sigma_m_per_s, motion->sigma_m_per_s,
                                    arm_sigma_m_per_s_);
    pings.emplace_back(reading.time, std::move(ping));
    return true;
  });
  return pings;
}

DvlMeasurement DvlFusion::measurementOf(std::vector<DvlPing> pings) const {
  DvlMeasurement measurement;
  measurement.pings = std::move(pings);
  measurement.robust_scale_sigmas = options_.robust_scale_sigmas;
  measurement.calibration_sigma = std::hypot(dvl_->scale_sigma, dvl_->misalignment_sigma_rad);
  return measurement;
}

std::shared_ptr<const Measurement> DvlFusion::measureBeforeStart(Time time) {
  if (!dvl_) return nullptr;
  NavigationState frame;
  frame.time = time;
  std::vector<DvlPing> pings;
  for (auto& [ping_time, ping] : pingsUntil(frame)) {
    if (!ping.isThroughWater()) pings.push_back(std::move(ping));
  }
  if (pings.empty()) return nullptr;
  return std::make_shared<DvlMeasurement>(measurementOf(std::move(pings)));
}

void DvlFusion::addStatesBeforeStart(Window& window, Prior& prior) const {
  if (!dvl_) return;
  if (!DvlStates(window)) {
    window.add({DvlStates::kScale, {0.0}, std::nullopt, options_.scale_walk_per_sqrt_s, true});
    window.add({DvlStates::kMisalignment, {0.0, 0.0, 0.0}, std::nullopt, 0.0, true});
  }
  const DvlStates states(window);
  const auto begin = [&](ParameterBlock& state, double sigma) {
    std::fill(state.value.begin(), state.value.end(), 0.0);
    const int size = static_cast<int>(state.value.size());
    prior.append(state.value.data(), size, Eigen::VectorXd::Constant(size, std::max(sigma, kHeld)));
  };
  begin(*states.scale, dvl_->scale_sigma);
  begin(*states.misalignment, dvl_->misalignment_sigma_rad);
}

void DvlFusion::start(double, Window* window, Prior* prior) {
  const DvlStates states(*window);
  const bool has_prior = std::any_of(prior->blocks.begin(), prior->blocks.end(), [&](const auto& block) {
    return states && block.value == states.scale->value.data();
  });
  if (!has_prior) addStatesBeforeStart(*window, *prior);
}

void DvlFusion::addCurrent(Window& window, Marginalizer& marginalizer) const {
  if (DvlStates(window).current != nullptr) return;
  ParameterBlock& current = window.add({DvlStates::kCurrent, std::vector<double>(kWaterCurrentSize, 0.0),
                                        std::nullopt, DvlStates::kCurrentWalk_m_per_s_per_sqrt_s, true});
  marginalizer.addKnowledge(current,
                            Eigen::VectorXd::Constant(kWaterCurrentSize, DvlStates::kCurrentSigma_m_per_s));
}

void DvlFusion::addToNewest(Window& window, Marginalizer& marginalizer) {
  if (!dvl_) return;
  Frame& newest = window.newest();
  estimate_.status = taken_;
  estimate_.beams = estimate_.used = 0;
  estimate_.innovation_m_per_s = 0.0;
  std::vector<DvlPing> used;
  for (auto& [time, ping] : pingsUntil(newest.state())) {
    const int beams = static_cast<int>(ping.rows.size());
    if (ping.isThroughWater()) addCurrent(window, marginalizer);
    const DvlStatus status = judge(time, window, &ping);
    see(status);
    if (status != DvlStatus::Waiting) estimate_.beams += beams;
    if (ping.rows.empty()) continue;
    estimate_.used += static_cast<int>(ping.rows.size());
    used.push_back(std::move(ping));
  }
  if (estimate_.beams > 0)
    estimate_.innovation_m_per_s = std::sqrt(estimate_.innovation_m_per_s / estimate_.beams);
  if (!used.empty()) newest.measurements.set(measurementOf(std::move(used)));
}

DvlStatus DvlFusion::judge(Time time, const Window& window, DvlPing* ping) {
  const DvlInnovation innovation = innovate(*ping, window, covariance_, options_.speed_sigma);
  estimate_.innovation_m_per_s += innovation.value_m_per_s.squaredNorm();
  const int rows = static_cast<int>(ping->rows.size());
  std::vector<DvlRow> agreeing;
  std::vector<int> all(ping->rows.size());
  std::iota(all.begin(), all.end(), 0);
  if (ping->is_velocity && innovation.agrees(all, options_.max_sigmas)) agreeing = ping->rows;
  for (int i = 0; !ping->is_velocity && i < rows; ++i) {
    if (innovation.agrees({i}, options_.max_sigmas)) agreeing.push_back(ping->rows[static_cast<size_t>(i)]);
  }
  // Where most beams of a ping disagree, the others agree by chance.
  constexpr int kFewest = 3;
  if (rows >= kFewest && 2 * static_cast<int>(agreeing.size()) <= rows) agreeing.clear();
  const int count = static_cast<int>(agreeing.size());
  const bool agrees = 2 * count > rows;
  trust_.add(time, agrees, innovation.isTest(options_.max_sigmas));
  if (trust_.isTrusted() || !agrees) {
    judged_ += rows;
    rejected_ += rows - (trust_.isTrusted() ? count : 0);
  }
  if (!agrees) reportRejections(time);
  if (!trust_.isTrusted()) return readmit(time, agrees, innovation, ping);
  ping->rows = std::move(agreeing);
  if (count == 0) return DvlStatus::Rejected;
  return ping->isThroughWater() ? DvlStatus::WaterTrack : DvlStatus::Used;
}

DvlStatus DvlFusion::readmit(Time time, bool agrees, const DvlInnovation& innovation, DvlPing* ping) {
  if (!trust_.isOverdue()) {
    ping->rows.clear();
    return agrees ? DvlStatus::Waiting : DvlStatus::Rejected;
  }
  diagnostics_->report(
      Severity::Warning, "dvl_readmitted",
      fmt::format("DVL: at {} ns its velocities have disagreed with the prediction for {:.0f} s; used again "
                  "with the noise that their disagreement shows",
                  time.nanoseconds(), trust_.waited_s()));
  // A healthy prediction outweighs it then, and one that drifts in the dark follows it.
  const double disagreement_m_per_s =
      std::sqrt(innovation.value_m_per_s.squaredNorm() / static_cast<double>(ping->rows.size()));
  ping->sigma_m_per_s = std::hypot(ping->sigma_m_per_s, disagreement_m_per_s);
  return DvlStatus::Readmitted;
}

void DvlFusion::reportRejections(Time time) {
  constexpr int kEnough = 50;
  constexpr double kMany = 0.5;
  if (is_rejection_reported_ || judged_ < kEnough || rejected_ < kMany * judged_) return;
  is_rejection_reported_ = true;
  diagnostics_->report(
      Severity::Warning, "dvl_rejected",
      fmt::format("DVL: up to {} ns {} of {} velocities disagree with the prediction and are not used. Check "
                  "the pose of the DVL in the calibration, the order and the sign of its beams, and the unit",
                  time.nanoseconds(), rejected_, judged_));
}

void DvlFusion::remember(const JointCovariance& covariance, Window& window) {
  if (!dvl_) return;
  covariance_ = covariance;
  const DvlStates states(window);
  if (!states) return;
  const auto sigma = [&](const ParameterBlock& state) {
    const double* value = state.value.data();
    if (!covariance_.knows(value)) return 0.0;
    return std::sqrt(std::max(0.0, covariance_.between(value, value).diagonal().maxCoeff()));
  };
  estimate_.scale = states.scale->value[0];
  estimate_.scale_sigma = sigma(*states.scale);
  estimate_.misalignment_rad = Vec3(states.misalignment->value.data());
  estimate_.misalignment_sigma_rad = sigma(*states.misalignment);
  if (states.current != nullptr) {
    estimate_.current_W = Vec3(states.current->value.data());
    estimate_.current_sigma_m_per_s = sigma(*states.current);
  }
  reportCalibration(window.newest().time);
}

void DvlFusion::reportCalibration(Time time) {
  constexpr double kSigmas = 4.0;
  if (is_calibration_reported_ || estimate_.scale_sigma == 0.0) return;
  const auto isOff = [](double value, double sigma, double stated_sigma) {
    return std::abs(value) > kSigmas * std::max({sigma, stated_sigma, kHeld});
  };
  const bool is_scaled = isOff(estimate_.scale, estimate_.scale_sigma, dvl_->scale_sigma);
  const Vec3& turn = estimate_.misalignment_rad;
  if (!is_scaled &&
      !isOff(turn.cwiseAbs().maxCoeff(), estimate_.misalignment_sigma_rad, dvl_->misalignment_sigma_rad))
    return;
  is_calibration_reported_ = true;
  const Vec3 degrees = kDegreesPerRadian * turn;
  diagnostics_->report(
      Severity::Warning, "dvl_calibration",
      fmt::format("DVL: at {} ns its velocities turn out to be {:.2f} % too large and its axes turned by "
                  "({:.2f}, {:.2f}, {:.2f}) degrees, more than its calibration allows. Check T_BS and the "
                  "speed of sound that is set",
                  time.nanoseconds(), 100.0 * estimate_.scale, degrees.x(), degrees.y(), degrees.z()));
}

void DvlFusion::report(const Window&, SensorEstimates* estimates) const { estimates->set(estimate_); }

std::optional<SensorRow> DvlFusion::row() const {
  if (!dvl_) return std::nullopt;
  const char* status = toString(estimate_.status);
  SensorRow row{std::string(name()), status, {{"dvl", status}}};
  row.columns.emplace_back("dvl_beams", fmt::format("{}", estimate_.beams));
  row.columns.emplace_back("dvl_used", fmt::format("{}", estimate_.used));
  const auto add = [&](const char* column, double value) {
    row.columns.emplace_back(column, fmt::format("{:.9g}", value));
  };
  add("dvl_innovation [m/s]", estimate_.innovation_m_per_s);
  add("dvl_scale", estimate_.scale);
  add("dvl_scale_sigma", estimate_.scale_sigma);
  add("dvl_misalignment_x [rad]", estimate_.misalignment_rad.x());
  add("dvl_misalignment_y [rad]", estimate_.misalignment_rad.y());
  add("dvl_misalignment_z [rad]", estimate_.misalignment_rad.z());
  add("dvl_misalignment_sigma [rad]", estimate_.misalignment_sigma_rad);
  return row;
}

std::vector<BatchState> DvlFusion::batchStates(const Window& window) const {
  if (!dvl_ || !DvlStates(window)) return {};
  BatchState scale{DvlStates::kScale}, misalignment{DvlStates::kMisalignment};
  if (options_.scale_walk_per_sqrt_s > 0.0) scale.walk_per_sqrt_s = options_.scale_walk_per_sqrt_s;
  scale.value = {0.0};
  scale.sigma = std::max(dvl_->scale_sigma, kHeld);
  misalignment.value = {0.0, 0.0, 0.0};
  misalignment.sigma = std::max(dvl_->misalignment_sigma_rad, kHeld);
  std::vector<BatchState> states = {scale, misalignment};
  if (DvlStates(window).current != nullptr) {
    BatchState& current = states.emplace_back(BatchState{DvlStates::kCurrent});
    current.walk_per_sqrt_s = DvlStates::kCurrentWalk_m_per_s_per_sqrt_s;
    current.value.assign(kWaterCurrentSize, 0.0);
    current.sigma = DvlStates::kCurrentSigma_m_per_s;
    current.is_added_late = true;
  }
  return states;
}

}  // namespace lodeline

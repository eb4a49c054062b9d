#include "lodeline/batch/estimator_log.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lodeline {
namespace {

constexpr double kLongestStart_s = 10.0;  // span of frames kept before the first pose

}  // namespace

void EstimatorLog::add(const FrameTracks& tracks, std::span<const ImuSample> imu,
                       const FrameEstimate& estimate, const Estimator& estimator) {
  for (const ImuSample& sample : imu) {
    if (imu_.empty() || sample.time > imu_.back().time) imu_.push_back(sample);
  }
  RecordedState state;
  state.state.time = tracks.time;
  state.observations = tracks.observations;
  if (!imu.empty()) state.gyroscope_B = imu.back().angular_velocity_B;
  if (estimate.status == Status::Waiting) {
    waiting_.push_back(std::move(state));
    const Time oldest = tracks.time - Duration::fromSeconds(kLongestStart_s);
    std::erase_if(waiting_, [&](const RecordedState& s) { return s.state.time < oldest; });
    std::erase_if(imu_, [&](const ImuSample& sample) { return sample.time < oldest; });
    return;
  }
  frames_.push_back(estimate);
  state.frame = frames_.size() - 1;
  if (frames_.size() == 1) {
    waiting_.push_back(std::move(state));
    start(estimate, estimator);
    return;
  }
  forgetEarlierEpochs(estimator);
  const Frame& newest = estimator.window().newest();
  state.state = estimate.state;
  state.is_keyframe = estimate.is_keyframe;
  state.measurements = newest.measurements;
  state.measurements.removeIf([](const Measurement& measurement) { return !measurement.isForBatch(); });
  for (const auto& sensor : estimator.sensors()) state.restarts.push_back(sensor->restarts());
  append(std::move(state));
}

void EstimatorLog::start(const FrameEstimate& estimate, const Estimator& estimator) {
  for (const auto& frame : estimator.window().frames()) {
    const auto seen = std::find_if(waiting_.begin(), waiting_.end(), [&](const RecordedState& state) {
      return state.state.time == frame->time;
    });
    if (seen == waiting_.end()) continue;
    RecordedState state = std::move(*seen);
    state.state = frame->time == estimate.time ? estimate.state : frame->state();
    state.is_keyframe = true;
    states_.push_back(std::move(state));
  }
  waiting_.clear();
  rememberPrior(estimator);
}

void EstimatorLog::forgetEarlierEpochs(const Estimator& estimator) {
  for (const auto& sensor : estimator.sensors()) {
    const std::string_view name = sensor->name();
    if (std::exchange(epochs_[name], sensor->measurementEpoch()) == sensor->measurementEpoch()) continue;
    used_[name] = 0;
    const auto isEarlier = [&](const Measurement& measurement) { return measurement.sensor() == name; };
    for (RecordedState& state : states_) state.measurements.removeIf(isEarlier);
    if (newest_) newest_->measurements.removeIf(isEarlier);
  }
}

void EstimatorLog::rememberPrior(const Estimator& estimator) {
  start_prior_.prior = estimator.prior();
  for (const Prior::Block& block : start_prior_.prior.blocks) {
    std::string name;
    for (const auto& frame : estimator.window().frames()) {
      if (block.value == frame->pose.data()) name = "pose";
      if (block.value == frame->motion.data()) name = "motion";
    }
    for (const auto& state : estimator.window().globals()) {
      if (block.value == state->value.data()) name = state->name;
    }
    start_prior_.names.push_back(name);
  }
}

bool EstimatorLog::isState(const RecordedState& candidate) const {
  const double since_s = (candidate.state.time - states_.back().state.time).seconds();
  // Times of images are not exactly evenly spaced.
  constexpr double kTolerance_s = 1e-3;
  const double short_interval_s = 0.4 * state_interval_s_;
  const bool is_wanted = std::any_of(candidate.measurements.begin(), candidate.measurements.end(),
                                     [](const auto& measurement) { return measurement->wantsBatchState(); });
  return candidate.is_keyframe || since_s > state_interval_s_ - kTolerance_s ||
         (is_wanted && since_s > short_interval_s);
}

void EstimatorLog::weighMeasurements(RecordedState* state) {
  Measurements weighted;
  for (const auto& measurement : state->measurements)
    weighted.add(measurement->weighted(std::exchange(used_[measurement->sensor()], 0)));
  state->measurements = std::move(weighted);
}

void EstimatorLog::append(RecordedState state) {
  for (const auto& measurement : state.measurements) ++used_[measurement->sensor()];
  const bool is_state = isState(state);
  newest_ = std::move(state);
  if (is_state) keepNewest();
}

void EstimatorLog::keepNewest() {
  if (!newest_) return;
  weighMeasurements(&*newest_);
  states_.push_back(std::move(*newest_));
  newest_.reset();
}

void EstimatorLog::finish(const Estimator& estimator) {
  if (newest_) states_.push_back(std::move(*newest_));
  newest_.reset();
  for (const auto& state : estimator.window().globals()) globals_[state->name] = state->value;
  sensor_states_.clear();
  for (size_t i = 0; i < estimator.sensors().size(); ++i) {
    for (BatchState& state : estimator.sensors()[i]->batchStates(estimator.window()))
      sensor_states_.push_back({i, std::move(state)});
  }
}

std::span<const ImuSample> EstimatorLog::imuBetween(Time begin, Time end) const {
  const auto before = [](const ImuSample& sample, Time time) { return sample.time < time; };
  const auto first = std::lower_bound(imu_.begin(), imu_.end(), begin, before);
  const auto last = std::lower_bound(first, imu_.end(), end, before);
  const size_t count = static_cast<size_t>(last - first) + (last != imu_.end() ? 1 : 0);
  return std::span(imu_).subspan(static_cast<size_t>(first - imu_.begin()), count);
}

InertialDoubt EstimatorLog::doubtBetween(Time begin, Time end) const {
  const auto first =
      std::upper_bound(frames_.begin(), frames_.end(), begin,
                       [](Time time, const FrameEstimate& frame) { return time < frame.time; });
  InertialDoubt sum;
  for (auto frame = first; frame != frames_.end() && frame->time <= end; ++frame) {
    const InertialDoubt& doubt = frame->inertial_doubt;
    sum.gyroscope_density_rad_per_s_sqrtHz =
        std::max(sum.gyroscope_density_rad_per_s_sqrtHz, doubt.gyroscope_density_rad_per_s_sqrtHz);
    sum.accelerometer_density_m_per_s2_sqrtHz =
        std::max(sum.accelerometer_density_m_per_s2_sqrtHz, doubt.accelerometer_density_m_per_s2_sqrtHz);
    sum.gyroscope_bias_step_rad_per_s =
        std::hypot(sum.gyroscope_bias_step_rad_per_s, doubt.gyroscope_bias_step_rad_per_s);
    sum.accelerometer_bias_step_m_per_s2 =
        std::hypot(sum.accelerometer_bias_step_m_per_s2, doubt.accelerometer_bias_step_m_per_s2);
  }
  return sum;
}

}  // namespace lodeline

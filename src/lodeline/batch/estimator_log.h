#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/estimator/estimator.h"

namespace lodeline {

/// A frame that is a state of the batch solution, with its measurements.
struct RecordedState {
  size_t frame = 0;  ///< index into EstimatorLog::frames(); for an initialization with one camera, of the
                     ///< frame at its end
  NavigationState state;  ///< as estimated in the forward run
  bool is_keyframe = false;
  Vec3 gyroscope_B = Vec3::Zero();  ///< reading at its time, rad/s
  std::vector<FeatureObservation> observations;
  Measurements measurements;  ///< of the sensors, those for the batch solution
  std::vector<int> restarts;  ///< SensorFusion::restarts() of each sensor
};

/// A parameter block of a sensor, and the sensor's number in RecordedState::restarts.
struct RecordedSensorState {
  size_t sensor = 0;
  BatchState state;
};

/// Record of a forward run for the batch solution: measurements of the states, all inertial readings, the
/// initial prior, and every estimate. States are the keyframes, the first and the last frame, and further
/// frames where these are far apart.
class EstimatorLog {
 public:
  static constexpr double kStateInterval_s = 0.5;

  /// Two states are at most about `state_interval_s` apart; with 0 every frame is a state.
  explicit EstimatorLog(double state_interval_s = kStateInterval_s) : state_interval_s_(state_interval_s) {}

  /// To be called after every Estimator::add() with its input and output.
  void add(const FrameTracks& tracks, std::span<const ImuSample> imu, const FrameEstimate& estimate,
           const Estimator& estimator);
  /// Makes the frame of the last add() a state, as a keyframe of the estimator is without that. For frames
  /// that are to be observed again, or that observe earlier ones again.
  void keepNewest();
  /// To be called after the last frame; may be called again after further ones.
  void finish(const Estimator& estimator);

  /// Estimates of all frames that have a pose.
  const std::vector<FrameEstimate>& frames() const { return frames_; }
  const std::vector<RecordedState>& states() const { return states_; }
  /// Without gaps from the first state to the last, with a reading at every frame's time.
  std::span<const ImuSample> imuBetween(Time begin, Time end) const;

  /// Noise that the run added to the readings between two times: the largest density, and the root sum of
  /// squares of all bias steps.
  InertialDoubt doubtBetween(Time begin, Time end) const;

  /// The prior at the start of the run. The pointers in its blocks are invalid; `names` identifies each:
  /// "pose" or "motion" of the first state, or a parameter block's name.
  struct StartPrior {
    Prior prior;
    std::vector<std::string> names;
  };
  const StartPrior& startPrior() const { return start_prior_; }
  /// Values of the parameter blocks at the end of the run.
  const std::map<std::string, std::vector<double>>& globals() const { return globals_; }
  /// The sensors' parameter blocks at the end of the run.
  const std::vector<RecordedSensorState>& sensorStates() const { return sensor_states_; }

 private:
  void start(const FrameEstimate& estimate, const Estimator& estimator);
  void rememberPrior(const Estimator& estimator);
  /// Removes recorded measurements that are of no use any more (SensorFusion::measurementEpoch).
  void forgetEarlierEpochs(const Estimator& estimator);
  /// Weighs the measurements of a state by those that were used since the last state that had one.
  void weighMeasurements(RecordedState* state);
  bool isState(const RecordedState& candidate) const;
  void append(RecordedState state);

  double state_interval_s_;
  std::vector<FrameEstimate> frames_;
  std::vector<RecordedState> states_;
  std::vector<ImuSample> imu_;
  StartPrior start_prior_;
  std::map<std::string, std::vector<double>> globals_;
  std::vector<RecordedState> waiting_;   ///< frames before the first pose
  std::optional<RecordedState> newest_;  ///< the last frame, if it is not a state
  /// Measurements of each sensor that were used since the last state that had one.
  std::map<std::string_view, int> used_;
  std::map<std::string_view, int> epochs_;  ///< SensorFusion::measurementEpoch() of each sensor
  std::vector<RecordedSensorState> sensor_states_;
};

}  // namespace lodeline

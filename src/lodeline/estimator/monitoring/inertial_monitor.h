#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <span>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/monitoring/motion_innovation.h"
#include "lodeline/estimator/monitoring/vibration_monitor.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Detects innovations that are improbable for longer than chance explains. Two statistics over half a second
/// decide: the mean of the normalized innovations squared (NIS), and the NIS of the sum of the innovations.
/// The sum finds an error that is small in each frame and has the same direction in all, as a bias has. Each
/// innovation is limited, so that no single frame can cause an alarm.
class InnovationWatch {
 public:
  /// Value that a correct model exceeds in less than one of 10^5 frames (chi-squared, 3 coordinates).
  static constexpr double kBeyondChance = 9.0;

  /// `sums`: the sum decides as well. It needs a covariance that is right for errors that last.
  explicit InnovationWatch(bool sums) : sums_(sums) {}

  void add(Time time, const Innovation& innovation);
  /// Whether the last innovation or the sum of the last ones is improbable.
  bool isBeyondChance() const { return is_beyond_chance_; }
  bool isAlarmed() const { return alarmed_since_.has_value(); }
  /// Time of the first improbable value among those that caused the alarm.
  Time alarmedSince() const { return *alarmed_since_; }
  /// Sum of the innovations of the last half second.
  Innovation sum() const;
  /// Mean length of these innovations along their sum.
  double meanLength() const { return sum().value.norm() / static_cast<double>(values_.size()); }

 private:
  struct Value {
    Time time;
    double nis;
    Innovation innovation;  ///< of length zero or with a NIS up to the limit
  };
  double meanNis() const;

  bool sums_;
  std::deque<Value> values_;
  std::optional<Time> alarmed_since_;
  std::optional<Time> last_beyond_chance_;
  bool is_beyond_chance_ = false;
};

/// Compares the motion predicted by inertial readings with the motion by images in every frame
/// (MotionInnovation), and reports contradictions as Serious findings.
///
/// If both contradict each other beyond chance, one of them is wrong. The body's inertia decides which: an
/// image that shows more acceleration than a rig can have, and more than the readings show, is left to
/// outlier rejection. Otherwise the inertial noise of the interval is enlarged to the size of the innovation,
/// so that images determine the frame. While the contradiction lasts, the sensor's bias may also step, so
/// that a bias that has jumped is estimated again. The remaining uncertainty is added to the covariance. A
/// vibration adds its noise in any case (VibrationMonitor).
class InertialMonitor {
 public:
  InertialMonitor(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
      : vibration_(rig, options.preintegration.noise_inflation),
        initial_(options.initial_state),
        diagnostics_(diagnostics) {}

  /// Takes the readings that lead to a frame.
  void take(std::span<const ImuSample> imu) { vibration_.add(imu); }

  /// Checks the newest frame before it is optimized, and enlarges the noise of its inertial term where
  /// necessary. `before`: covariance of the frame before, see motionInnovation().
  void check(Window& window, const FactorBuilder& factors, const Eigen::Matrix<double, 15, 15>& before);

  bool isGyroscopeDoubted() const { return gyroscope_.isAlarmed(); }
  bool isAlarmed() const {
    return gyroscope_.isAlarmed() || accelerometer_.isAlarmed() || images_.isAlarmed();
  }

  /// Adds the uncertainty from all contradictions up to a frame to the covariance of its [dp, dtheta, dv,
  /// db_g, db_a].
  void addTo(const Vec3& position_W, Eigen::Matrix<double, 15, 15>* covariance) const;

 private:
  bool areImagesSuspected(const MotionInnovation& innovation) const;
  void widen(const MotionInnovation& innovation, Window& window);
  /// Enlarges the noise of the intervals in the window that caused a new alarm, and adds the sum of their
  /// innovations to the uncertainty.
  void widenBackwards(const InnovationWatch& watch, Window& window);
  void doubtMotion(const Vec3& position_error_W, const Vec3& rotation_error_W, const Vec3& position_W);
  void report(const MotionInnovation& innovation, Time time, const InnovationWatch& watch,
              const char* sensor);

  VibrationMonitor vibration_;
  InitialStateOptions initial_;
  Diagnostics* diagnostics_;
  // The scale of one camera can be wrong by more than its covariance says. Rotations have no scale.
  InnovationWatch gyroscope_{true}, accelerometer_{false}, images_{false};
  bool is_before_placed_ = false;
  Mat3 position_doubt_ = Mat3::Zero();  ///< m^2
  Mat3 rotation_doubt_ = Mat3::Zero();  ///< rad^2
  /// Sums of the rotation variances times 1, times the position where they arose, and times its outer
  /// product.
  double turned_ = 0.0;
  Vec3 turned_at_W_ = Vec3::Zero();
  Mat3 turned_at_squared_ = Mat3::Zero();
};

}  // namespace lodeline

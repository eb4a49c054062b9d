#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "lodeline/estimator/monitoring/motion_innovation.h"
#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Whether a normalized innovation squared stays beyond chance for longer than chance allows. Its mean over
/// half a second decides, each value cut off, so that no single frame can raise an alarm.
class InnovationWatch {
 public:
  /// A value that a correct model exceeds in less than one of 10^5 frames (chi-squared, 3 coordinates).
  static constexpr double kBeyondChance = 9.0;

  void add(Time time, double nis);
  bool isAlarmed() const { return alarmed_since_.has_value(); }
  /// When the first value beyond chance came of those that raised the alarm.
  Time alarmedSince() const { return *alarmed_since_; }

 private:
  struct Value {
    Time time;
    double nis;
  };
  std::deque<Value> values_;
  std::optional<Time> alarmed_since_;
  std::optional<Time> last_beyond_chance_;
};

/// Compares, in every frame, the motion that the inertial readings predict with the motion that the images
/// show (MotionInnovation), and reports contradictions as Serious findings.
///
/// Where both contradict each other beyond chance, one of them is wrong, and a body's inertia tells which: an
/// image that shows more acceleration than a rig can have, and more than the readings say, is left to the
/// outlier rejection. Otherwise the interval's inertial noise is widened by as much as the innovation, so
/// that images carry the frame; while the contradiction lasts, the sensor's bias may step as well, so that a
/// bias that has jumped is found again. What is left in doubt is added to the covariance.
class InertialMonitor {
 public:
  InertialMonitor(const EstimatorOptions& options, Diagnostics* diagnostics)
      : initial_(options.initial_state), diagnostics_(diagnostics) {}

  /// Checks the newest frame before it is optimized, and widens its inertial term. `before`: covariance of
  /// the frame before, see motionInnovation().
  void check(Window& window, const FactorBuilder& factors, const Eigen::Matrix<double, 15, 15>& before);

  bool isGyroscopeDoubted() const { return gyroscope_.isAlarmed(); }
  bool isAlarmed() const {
    return gyroscope_.isAlarmed() || accelerometer_.isAlarmed() || images_.isAlarmed();
  }

  /// Adds to the covariance of a frame's [dp, dtheta, dv, db_g, db_a] what contradictions up to it have left
  /// in doubt.
  void addTo(const Vec3& position_W, Eigen::Matrix<double, 15, 15>* covariance) const;

 private:
  bool areImagesSuspected(const MotionInnovation& innovation) const;
  void widen(const MotionInnovation& innovation, Window& window);
  void doubtMotion(const Vec3& position_error_W, const Vec3& rotation_error_W, const Vec3& position_W);
  void report(const MotionInnovation& innovation, Time time, const InnovationWatch& watch,
              const char* sensor);

  InitialStateOptions initial_;
  Diagnostics* diagnostics_;
  InnovationWatch gyroscope_, accelerometer_, images_;
  bool is_before_placed_ = false;
  Mat3 position_doubt_ = Mat3::Zero();  ///< m^2
  Mat3 rotation_doubt_ = Mat3::Zero();  ///< rad^2
  /// Of the rotation's doubts, their variances times 1, where they arose, and its outer product.
  double turned_ = 0.0;
  Vec3 turned_at_W_ = Vec3::Zero();
  Mat3 turned_at_squared_ = Mat3::Zero();
};

}  // namespace lodeline

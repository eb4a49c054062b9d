#pragma once

#include <any>
#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Navigation state at one moment.
struct NavigationState {
  Time time;
  Rigid3 world_from_body;
  Vec3 velocity_W = Vec3::Zero();            ///< m/s
  Vec3 gyroscope_bias_B = Vec3::Zero();      ///< rad/s
  Vec3 accelerometer_bias_B = Vec3::Zero();  ///< m/s^2
};

/// Covariance inflation of one interval of inertial readings that images contradict: white noise densities,
/// and steps of the biases, one sigma per axis.
struct InertialDoubt {
  double gyroscope_density_rad_per_s_sqrtHz = 0.0;
  double accelerometer_density_m_per_s2_sqrtHz = 0.0;
  double gyroscope_bias_step_rad_per_s = 0.0;
  double accelerometer_bias_step_m_per_s2 = 0.0;

  bool any() const {
    return gyroscope_density_rad_per_s_sqrtHz > 0.0 || accelerometer_density_m_per_s2_sqrtHz > 0.0 ||
           gyroscope_bias_step_rad_per_s > 0.0 || accelerometer_bias_step_m_per_s2 > 0.0;
  }
};

/// Scale and misalignment errors D of a sensor's calibrated axes: the true value is (I + D) (reading - bias).
/// D is stored column by column; 0 for a sensor as calibrated. (D_w and D_a in Yang et al., "Online IMU
/// intrinsic calibration: is it necessary?", RSS 2020.)
using SensorAxes = Eigen::Matrix<double, 9, 1>;

/// Identifies one physical point as long as it is tracked; never reused.
using TrackId = int64_t;

/// A landmark that has left the window and will not change any more.
struct MapPoint {
  TrackId track = -1;
  Vec3 position_W = Vec3::Zero();  ///< m
  int observations = 0;            ///< number in the window when it left
};

/// A point of a map, in the world of the map's trajectory.
struct MapLandmark {
  Vec3 position = Vec3::Zero();  ///< m
  int observations = 0;
};

/// What the estimator has for a frame.
enum class Status {
  Waiting,   ///< not initialized; no pose
  Tracking,  ///< images and inertial readings
  /// The same, but these contradict each other (InertialMonitor): carried on by what is more plausible, with
  /// wider uncertainty.
  Degraded,
  Inertial,  ///< too few landmarks are seen: carried on by inertial readings alone
};
const char* toString(Status status);

/// What the estimator does with a new frame.
enum class Mode {
  Waiting,       ///< no window: images and readings are collected until a start is possible
  StartingUp,    ///< every frame stays in the window, nothing is marginalized
  Tracking,      ///< the window slides: old frames are marginalized
  InertialOnly,  ///< the newest frames see too few landmarks: inertial readings alone carry the pose
  Recovering,    ///< images are back, but the scale of one camera is lost: as StartingUp
};
const char* toString(Mode mode);

/// Changes of a camera's intrinsics: both focal lengths (relative), principal point (px), two radial and two
/// tangential coefficients, two of a tilted port. docs/theory/self-calibration.md has the formula.
using IntrinsicsCorrection = Eigen::Matrix<double, 10, 1>;

/// Change of the port of a camera against its file: for a plate the turn of the normal about x and y of the
/// camera (rad) and of the distance (m), for a dome that of the centre (m). All zero without a port.
struct PortCorrection {
  Vec3 change = Vec3::Zero();
  Vec3 sigma = Vec3::Zero();  ///< claimed error of the change; NaN where no covariance was computed
  bool is_dome = false;
};

/// Present values of the camera calibration states.
struct CameraCorrections {
  std::vector<Eigen::Matrix<double, 6, 1>> extrinsics;  ///< [phi, xi] of each camera, rad and m
  double time_offset_s = 0.0;                           ///< to be added to the images' time stamps
  std::vector<double> line_delays_s;  ///< of each camera's rolling shutter; empty where all are global
  /// Of each camera as in factors/intrinsics_factor.h; empty where the intrinsics are not estimated.
  std::vector<IntrinsicsCorrection> intrinsics;
  std::vector<PortCorrection> ports;  ///< of each camera, by the batch solution; empty where all are held
  bool are_files_held = false;        ///< of intrinsics and secondary rotations, see IntrinsicsModelSelection
};

/// Direction of the world's y axis.
enum class HeadingReference {
  Automatic,  ///< True where the field at the site is known, else Magnetic
  True,
  Magnetic,
  Start,  ///< the world is rotated so that the first pose has no yaw
};
const char* toString(HeadingReference reference);

/// Status of the magnetometer in one frame.
enum class MagnetometerStatus {
  Off,           ///< not requested, or not on board
  NoData,        ///< no usable reading since the frame before
  Used,          ///< accepted as the Earth's field
  Norm,          ///< rejected: the field has another size
  Dip,           ///< rejected: the field has another inclination
  Innovation,    ///< rejected: the heading disagrees with gyroscope and images
  Readmitted,    ///< rejected for so long that the field is accepted again, with an estimated disturbance
  Inconsistent,  ///< all readings rejected: the field has disagreed for longer than it has agreed
  Uncalibrated,  ///< not used because its hard and soft iron are unknown
};
const char* toString(MagnetometerStatus status);

/// Status of the magnetometer in a frame, and the estimate of its field.
struct MagnetometerEstimate {
  MagnetometerStatus status = MagnetometerStatus::Off;
  HeadingReference heading_reference = HeadingReference::Start;
  /// Rotation about the vertical, rad, from the estimator's world to a world whose y axis points to that
  /// reference, by the present estimate; empty while north is unknown. The estimator's world itself never
  /// rotates after its first pose, which points to north as well as the first readings tell.
  std::optional<double> north_from_world_rad;
  double north_from_world_sigma_rad = 0.0;  ///< of that rotation, relative to the heading of the first pose
  std::optional<Time> north_found;          ///< time of the first pose with a known north
  int field_epoch = 0;  ///< counts replacements of the field that is taken for the Earth's
  /// Sigmas of the heading relative to that reference, rad: from the frame's covariance, and of the
  /// declination.
  double heading_sigma_rad = 0.0;
  double declination_sigma_rad = 0.0;
  /// Sigma of the heading that the window's covariance does not contain: from the axes of an uncalibrated
  /// magnetometer, or of an IMU that may never have been calibrated and against which the magnetometer was
  /// calibrated.
  double axes_sigma_rad = 0.0;
  /// Estimated field of the Earth and offset of the corrected readings, T; empty unless the use is Absolute.
  std::optional<Vec3> field_W;
  std::optional<Vec3> offset_B;
  std::optional<double>
      correlated_noise_sigma_T;  ///< time-correlated error of the field per axis, as estimated
};

/// A normal distribution of a scalar.
struct ScalarPrior {
  double value = 0.0, sigma = 0.0;
};

/// Status of the pressure sensor in one frame.
enum class DepthStatus {
  Off,     ///< not requested, or not on board
  NoData,  ///< no reading since the frame before
  Used,
  Jump,       ///< rejected: a spike, or the first readings after a step
  Restarted,  ///< used, from now on with another offset
  Frozen,     ///< rejected: constant readings while the rig rises or sinks
  Slope,      ///< rejected: readings do not follow the rig's rise and fall, as in another unit
};
const char* toString(DepthStatus status);

/// Status of the pressure sensor in a frame, and the estimate of its gauge; see DepthStates.
struct DepthEstimate {
  DepthStatus status = DepthStatus::Off;
  struct Gauge {
    double depth_at_origin_m = 0.0;
    double density_ratio = 1.0, density_ratio_sigma = 0.0;
    double lag_s = 0.0, lag_sigma_s = 0.0;
    double body_depth_m = 0.0;  ///< of the body in the water, by the estimated density
    /// Sigma of the density ratio beyond the window's covariance.
    double unmodelled_sigma = 0.0;
    /// Sigma of the density ratio without images.
    double told_sigma = 0.0;
    std::optional<ScalarPrior> prior = std::nullopt;  ///< of the density ratio, see ParameterBlock
  };
  std::optional<Gauge> gauge;  ///< empty until the first reading

  /// Value for EstimateSources::density_sigma.
  std::optional<double> unmodelledDensitySigma() const {
    return gauge ? std::optional(gauge->unmodelled_sigma) : std::nullopt;
  }
};

/// Information that each sensor gives about the scale: 1 / sigma^2 of the logarithm of the scale.
struct ScaleInformation {
  double stereo = 0.0;
  double accelerometer = 0.0;
  double depth = 0.0;
  double dvl = 0.0;

  double sum() const { return stereo + accelerometer + depth + dvl; }
};

/// What a sensor reports about a frame, in words and numbers for files and summaries.
struct SensorRow {
  std::string sensor;
  std::string status;
  std::vector<std::pair<std::string, std::string>> columns;  ///< of states.csv: name with unit, value
};

/// What the sensors report about a frame: one estimate of each kind at most, such as MagnetometerEstimate or
/// DepthEstimate. A reference stays valid when other kinds are added.
class SensorEstimates {
 public:
  /// The estimate of a kind; the default one where there is none.
  template <typename Kind>
  const Kind& of() const {
    static const Kind none;
    const Kind* found = find<Kind>();
    return found ? *found : none;
  }
  /// The same to be changed; added where there is none.
  template <typename Kind>
  Kind& of() {
    if (const Kind* found = find<Kind>()) return const_cast<Kind&>(*found);
    return std::any_cast<Kind&>(items_.emplace_back(Kind()));
  }
  template <typename Kind>
  void set(Kind estimate) {
    of<Kind>() = std::move(estimate);
  }

 private:
  template <typename Kind>
  const Kind* find() const {
    for (const std::any& item : items_) {
      if (const auto* found = std::any_cast<Kind>(&item)) return found;
    }
    return nullptr;
  }
  std::list<std::any> items_;
};

/// What is known right after a frame was added; never revised later.
struct FrameEstimate {
  Time time;
  Status status = Status::Waiting;
  std::string waiting_for;  ///< in words, while waiting
  NavigationState state;
  /// Of [dp, dtheta, dv, db_g, db_a] (world axes, see parameters.h). Relative to the first position and
  /// to north. While north is unknown, relative to the first heading.
  Eigen::Matrix<double, 15, 15> covariance = Eigen::Matrix<double, 15, 15>::Zero();
  /// The same as the stated model gives it, without the inflation for errors that have no state
  /// (docs/theory/covariance.md).
  Eigen::Matrix<double, 15, 15> posterior_covariance = Eigen::Matrix<double, 15, 15>::Zero();
  InertialDoubt inertial_doubt;  ///< of the readings since the frame before
  bool is_keyframe = false;
  int tracks = 0;     ///< seen in this frame
  int landmarks = 0;  ///< of which have a position
  double reprojection_rms_sigmas = 0.0;
  std::optional<double> scene_distance_m;  ///< of the landmarks, in harmonic mean
  int solver_iterations = 0;
  Mode mode = Mode::Waiting;  ///< the estimator's, after this frame
  /// Nothing where the calibration is taken as the files give it.
  std::optional<CameraCorrections> camera_corrections;
  std::optional<SensorAxes> gyroscope_axes;      ///< the same
  std::optional<SensorAxes> accelerometer_axes;  ///< the same
  SensorEstimates sensors;                       ///< of magnetometer, pressure sensor and others
  std::vector<SensorRow> sensor_rows;            ///< SensorFusion::row() of each sensor that has one
  ScaleInformation scale;                        ///< what carries it at present
};

/// What the batch solution of a recording is like.
struct RefinementSummary {
  /// Reason why there is no batch solution; empty where there is one.
  std::string refusal;
  bool converged = false;  ///< the last round converged
  int states = 0;
  int64_t landmarks = 0;
  int64_t observations = 0;           ///< of these
  double observation_variance = 1.0;  ///< of an observation over the stated one (TimeCorrelatedErrors)
  double design_effect = 1.0;         ///< observations that count as one in the reported covariance
  double outlier_share = 0.0;         ///< of the observations, removed at the end
  int iterations = 0;                 ///< of all rounds
  double forward_cost = 0.0;          ///< of the forward run's states
  double first_round_cost = 0.0;      ///< cost of the same terms after the first round
  double cost = 0.0;                  ///< cost of the remaining terms at the end
  double moved_rms_m = 0.0;           ///< difference of refined and forward positions, over all frames
  double moved_max_m = 0.0;
  double turned_rms_rad = 0.0;
  double forward_sigma_m = 0.0,
         sigma_m = 0.0;  ///< reported for the last frame: root of the trace of the position covariance
  double processor_s = 0.0;
  bool has_covariance = false;
  std::optional<CameraCorrections> camera_corrections;  ///< if ports are states
  /// Pairs of landmarks, and of a landmark and a single observation, that loop observations connect: those
  /// found in the record, and those in use at the end.
  int loop_links = 0, loop_links_used = 0;

  bool usable() const { return refusal.empty(); }
};

/// What the map of a dive is like.
struct MappingSummary {
  int keyframes = 0;
  int candidates = 0;  ///< pairs of keyframes that were compared
  int verified = 0;    ///< of these, explained by one motion
  int accepted = 0;    ///< of these, used as loops
  int refused = 0;
  int accepted_between_dives = 0;  ///< of the accepted ones
  bool is_placed = true;           ///< in the earlier map, if the run started from one
  double processor_s = 0.0;
};

/// The batch solution of a whole recording.
struct Refinement {
  RefinementSummary summary;
  /// Estimates of all frames of the record from all measurements, before and after each frame; those of the
  /// forward run where there is no solution. Covariance as in FrameEstimate, of the batch solution; nan where
  /// it was not computed.
  std::vector<FrameEstimate> frames;
  std::vector<MapPoint> landmarks;
};

}  // namespace lodeline

#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// Pose of a body (or a camera) at one time, in the world of its trajectory.
struct StampedPose {
  Time time;
  Rigid3 world_from_body;
};

/// Origin of a trajectory's times. Formats without times (KITTI) number their rows: such a trajectory can
/// only be associated by index.
enum class TimeBase { Stamps, Index };

/// The world axis that points up. Camera-based formats (KITTI) have y down.
enum class WorldUp { Z, MinusY };

/// Poses in the order of their times; `sortByTime` sorts them.
struct Trajectory {
  std::string name;  ///< source, for messages
  TimeBase time_base = TimeBase::Stamps;
  WorldUp up = WorldUp::Z;
  std::size_t rows = 0;  ///< of a table without times, including skipped rows
  std::vector<StampedPose> poses;

  bool empty() const { return poses.empty(); }
  std::size_t size() const { return poses.size(); }
};

/// Orders the poses by time and keeps the first of several poses with the same time; both are reported as
/// warnings ("trajectory_disorder", "trajectory_duplicate").
void sortByTime(Trajectory& trajectory, Diagnostics& diagnostics);

/// The same trajectory in a world whose z axis points up.
Trajectory withZUp(Trajectory trajectory);

/// Path length (m) from the first pose to each pose; same size as `poses`, the first is 0.
std::vector<double> distancesFromStart(const std::vector<Rigid3>& world_from_body);

/// Path length (m) of the whole trajectory, 0 when it has fewer than two poses.
double pathLength(const Trajectory& trajectory);

/// Typical (median) interval between poses; zero when there are fewer than two.
Duration medianInterval(const Trajectory& trajectory);

/// Layouts of trajectories that can be read.
enum class TrajectoryFormat {
  Table,         ///< columns by their header, or by their position (readPoseTable)
  Tum,           ///< `t x y z qx qy qz qw`, further columns ignored
  Kitti,         ///< 12 numbers per line: the upper 3x4 part of world_from_camera, row by row; no times
  Euroc,         ///< `t, x, y, z, qw, qx, qy, qz, ...`, the EuRoC ground truth
  ColmapText,    ///< COLMAP images.txt
  ColmapBinary,  ///< COLMAP images.bin
};

/// "table", "tum", "kitti", "euroc", "colmap-text", "colmap-binary" and back; UsageError for another name.
const char* toString(TrajectoryFormat format);
TrajectoryFormat trajectoryFormatFromString(const std::string& name);

struct TrajectoryReadOptions {
  std::optional<TrajectoryFormat> format;  ///< detected from the file when absent

  /// Times of COLMAP images: lines `name time[s]` or EuRoC's `time[ns],name`. Without it the file names must
  /// be times (nanoseconds, or seconds with a decimal point).
  std::optional<std::filesystem::path> image_times;

  /// Transformation of COLMAP's camera poses to body poses.
  std::optional<Rigid3> body_from_camera;
};

/// The file that contains the poses, and its layout.
struct TrajectorySource {
  std::filesystem::path file;
  TrajectoryFormat format;
};

/// Finds the poses: a file in one of the layouts (text may be compressed with gzip), or a folder.
/// Folders are those of `lodeline run`, of a EuRoC recording (also `mav0`,
/// `state_groundtruth_estimate0`), or of a COLMAP model. Throws InputError, with the expected files,
/// when nothing fits.
TrajectorySource findTrajectory(const std::filesystem::path& path,
                                std::optional<TrajectoryFormat> format = std::nullopt);

/// Reads a trajectory and orders it by time. Tables may be in UTF-8, UTF-16 or Latin-1, with any line ends
/// and separators (TableReader). Throws InputError with file and line: for a line that does not fit its
/// layout, a quaternion that is no rotation, or no poses. Poses with NaN ("lost" in some references) and
/// an incomplete last line are skipped with a warning.
Trajectory readTrajectory(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics);

/// Writes a trajectory in the TUM layout, time stamps exact to 1 ns. Throws InputError where that fails.
void writeTum(const Trajectory& trajectory, const std::filesystem::path& file);

enum class AssociationMethod {
  Nearest,      ///< the reference pose that is nearest in time
  Interpolate,  ///< the reference interpolated to the time of the estimate (linear position, slerp rotation)
};

struct AssociationOptions {
  AssociationMethod method = AssociationMethod::Nearest;
  /// Nearest: largest accepted time difference. Interpolate: largest accepted distance to either neighbour.
  double tolerance_s = 0.01;
  /// Added to every time of the estimate.
  double time_offset_s = 0.0;
};

/// Poses of estimate and reference at the same times, in order; all vectors have equal size.
struct PosePairs {
  std::vector<Time> time;  ///< on the clock of the reference
  std::vector<Rigid3> estimate;
  std::vector<Rigid3> reference;

  std::size_t size() const { return time.size(); }
};

/// Associates the poses of two trajectories in order of time. Two trajectories without times are associated
/// by index. By time, each pose is used at most once: of several with the same partner, the closest one is
/// used. The trajectory with fewer poses chooses, so that a dense estimate and a sparse reference give one
/// pair per reference pose. Throws InputError in these cases: only one trajectory has times, nothing matches
/// (the message names both spans), or tables without times differ in their number of rows.
PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    const AssociationOptions& options);

/// Type of the transformation from the world of the estimate to that of the reference before errors are
/// computed. It should contain the unobservable directions of the estimator: visual-inertial odometry does
/// not know position and yaw (Yaw), a single camera alone does not know the scale either (Sim3).
enum class AlignmentType { None, Yaw, SE3, Sim3 };

/// "none", "yaw", "se3", "sim3" and back; UsageError for another name.
const char* toString(AlignmentType type);
AlignmentType alignmentTypeFromString(const std::string& name);

/// p_reference = scale * R * p_estimate + t.
struct Alignment {
  double scale = 1.0;
  Rigid3 reference_from_estimate;  ///< R and t (m); t is applied after the scale

  /// Whether the rotation comes from the orientations, because the positions do not determine it (fewer than
  /// three, all at one position or on one line; for Yaw: no horizontal extent).
  bool rotation_from_orientations = false;

  Rigid3 apply(const Rigid3& estimate_world_from_body) const;

  /// Relative scale error of the estimate, positive where it is too large: 1/scale - 1.
  double scaleError() const { return 1.0 / scale - 1.0; }
};

/// The least-squares alignment of the positions. SE3 and Sim3: Umeyama, "Least-squares estimation of
/// transformation parameters between two point patterns", PAMI 1991. Yaw: the closed form of Zhang &
/// Scaramuzza, "A tutorial on quantitative trajectory evaluation for visual(-inertial) odometry", IROS 2018.
/// Where the positions do not determine the rotation, it is the chordal mean of the rotations between the two
/// trajectories' orientations. Throws InputError without pairs, and for Sim3 when the estimate or the
/// reference has no extent, so that the scale is undetermined.
Alignment align(AlignmentType type, const PosePairs& pairs);

/// Alignment of the first poses in the free directions of `type` (Yaw: position and yaw). Sim3 keeps `scale`,
/// which a single pose does not determine.
Alignment alignFirstPose(AlignmentType type, const PosePairs& pairs, double scale);

/// Reference direction of an estimate's heading.
enum class HeadingBasis {
  North,  ///< its y axis is north like that of the reference, so its heading has no free direction
  Start,  ///< its first heading is arbitrary
};

const char* toString(HeadingBasis basis);

/// Basis of a run from the name of its heading reference (`heading.reference` of run.json). Magnetic north
/// differs from the reference's north by a declination that such a run does not know.
HeadingBasis headingBasisOf(const std::string& heading_reference);

/// Alignment of the first positions and, with HeadingBasis::Start, of the first headings.
Alignment alignStarts(HeadingBasis basis, const PosePairs& pairs);

/// The estimate's poses in the world of the reference.
std::vector<Rigid3> applyAlignment(const Alignment& alignment, const std::vector<Rigid3>& estimate);

/// Summary of a set of error values, in their unit. All zero for an empty set.
struct Statistics {
  std::size_t count = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double std = 0.0;  ///< root mean squared deviation from the mean (divisor: count)
  double min = 0.0;
  double lower_quartile = 0.0;
  double median = 0.0;
  double upper_quartile = 0.0;
  double max = 0.0;
};

Statistics computeStatistics(const std::vector<double>& values);

/// Quantile: value below which the share `fraction` (0 to 1) of the sorted values lies, interpolated linearly
/// between neighbours. The values must be sorted and not empty.
double quantile(const std::vector<double>& sorted_values, double fraction);

/// Differences of an aligned estimate from the reference for each pose. Rotation error matrix in the world: E
/// = R_estimate * R_reference^T; its angle is the rotation error, its yaw atan2(E(1,0), E(0,0)).
struct AbsoluteErrors {
  std::vector<Vec3> position_m;      ///< estimate minus reference, in the reference's world
  std::vector<double> rotation_deg;  ///< angle in [0, 180]
  std::vector<double> yaw_deg;       ///< about the world's z axis, signed, in [-180, 180]

  Statistics position() const;  ///< of the norms, m
  Statistics rotation() const;  ///< deg
  Statistics yaw() const;       ///< of the absolute values, deg
};

/// `aligned` holds the estimate's poses in the reference's world, one for each of `reference`.
AbsoluteErrors computeAbsoluteErrors(const std::vector<Rigid3>& aligned,
                                     const std::vector<Rigid3>& reference);

/// Start and end index of a section of the path.
struct Stretch {
  std::size_t start = 0;
  std::size_t end = 0;
};

/// One section for every start pose: the end is the pose whose distance along the path is closest to
/// `length_m`; start poses without one within `tolerance_m` are skipped. (Selection of Zhang & Scaramuzza
/// 2018, section V, who adopted it from KITTI.)
std::vector<Stretch> overlappingStretches(const std::vector<double>& distances_m, double length_m,
                                          double tolerance_m);

/// Consecutive sections that share only their ends; each ends at the first pose at least `length_m` of path
/// after its start. The first starts where the path is `length_m` long (the selection of evo 1.x for
/// "consecutive pairs").
std::vector<Stretch> consecutiveStretches(const std::vector<double>& distances_m, double length_m);

/// Errors of the relative motion over sections of one length, one value per section. E = (T_ref_start^-1
/// T_ref_end)^-1 (T_est_start^-1 T_est_end).
struct RelativeErrors {
  double length_m = 0.0;
  std::vector<double> translation_m;        ///< |translation of E|
  std::vector<double> translation_percent;  ///< of `length_m`
  std::vector<double> rotation_deg;         ///< angle of E
  std::vector<double> rotation_deg_per_m;   ///< of `length_m`
  std::vector<double> yaw_deg;              ///< |yaw| of E rotated into the world

  std::size_t size() const { return translation_m.size(); }
};

/// `aligned` needs the correct scale and a vertical z axis (yaw is that of R_est_end E R_est_end^T about z),
/// but not the correct position.
RelativeErrors computeRelativeErrors(const std::vector<Rigid3>& aligned, const std::vector<Rigid3>& reference,
                                     const std::vector<Stretch>& stretches, double length_m);

/// Share of the expected poses that were estimated.
struct Completion {
  double share = 0.0;         ///< 0 to 1
  bool by_images = false;     ///< share of images with a pose; otherwise share of the reference's time
  std::size_t expected = 0;   ///< images
  std::size_t estimated = 0;  ///< images
};

/// Share of the images that have an estimated pose within `tolerance` of their time.
Completion completionByImages(const Trajectory& estimate, const std::vector<Time>& image_stamps,
                              Duration time_offset, Duration tolerance);

/// Share of the reference's time span that the estimate covers. A gap between two poses counts as covered if
/// it is shorter than a second or three times the estimate's usual interval. The spacing of a keyframe
/// trajectory is then not a gap. 0 for a reference of zero duration.
Completion completionByTime(const Trajectory& estimate, const Trajectory& reference, Duration time_offset);

/// One pose with the reported sigmas of its errors.
struct ReportedPose {
  StampedPose pose;
  Vec3 position_sigma_m = Vec3::Zero();    ///< axes of the estimate's world
  Vec3 rotation_sigma_rad = Vec3::Zero();  ///< the same; z: of the heading
};

/// Poses of `lodeline run`.
struct ReportedUncertainty {
  std::vector<ReportedPose> poses;
  HeadingBasis basis = HeadingBasis::Start;  ///< reference direction of the heading's sigma
};

/// Errors of one kind compared with their standard deviations, for each axis of the estimate's world.
struct ReportedAxes {
  Vec3 within_3_sigma_percent = Vec3::Zero();  ///< of the poses; 99.7 for normal and white errors
  Vec3 rms_sigmas = Vec3::Zero();              ///< of error over sigma; 1 where the sigma is exact
};

/// Comparison of errors with their reported sigmas.
struct ConsistencyCheck {
  std::size_t poses = 0;
  HeadingBasis basis = HeadingBasis::Start;
  ReportedAxes position;
  ReportedAxes rotation;
};

/// Computes errors relative to a reference from equal first positions and, with HeadingBasis::Start, equal
/// first headings, because the sigmas of a run refer to these. The errors are rotated to the axes of the
/// estimate's world, because distances along and across the path may have very different sigmas. The first
/// pair has no error by construction and does not count. `poses` is 0 without reported sigmas or without
/// times in the reference. Throws InputError as associate() does.
ConsistencyCheck checkConsistency(const ReportedUncertainty& claims, const Trajectory& reference,
                                  const AssociationOptions& association);

struct EvaluationOptions {
  AssociationOptions association;
  AlignmentType alignment = AlignmentType::SE3;
  /// Number of first pairs used for the alignment; 0 uses all.
  std::size_t alignment_pairs = 0;
  /// Lengths (m) of the overlapping sections; empty: 10, 20, 30, 40 and 50 % of the reference's path, rounded
  /// to two digits.
  std::vector<double> stretch_lengths_m;
  /// Length (m) of the consecutive sections.
  double consecutive_length_m = 10.0;
  /// Time stamps of the images that should have a pose; empty: completion is computed from time.
  std::vector<Time> expected_stamps;
};

/// Results of one evaluation. All positions are in the world of the reference, z up.
struct Evaluation {
  EvaluationOptions options;
  Trajectory estimate;   ///< as given, rotated to z up
  Trajectory reference;  ///< as given, rotated to z up

  PosePairs pairs;  ///< before alignment
  Alignment alignment;
  std::vector<Rigid3> aligned_estimate;      ///< one for each pair
  std::vector<double> reference_distance_m;  ///< path length from the first pair, one for each pair

  AbsoluteErrors absolute;
  std::vector<RelativeErrors> relative;  ///< overlapping sections, one entry per length
  RelativeErrors consecutive;            ///< consecutive sections; empty when the path is too short

  double reference_path_m = 0.0;  ///< along the pairs
  double estimate_path_m = 0.0;   ///< along the pairs, in the estimate's own scale
  double end_point_m = 0.0;       ///< position error of the last pair after `alignment`
  double drift_m = 0.0;           ///< position error of the last pair after alignment of the first pair

  Completion completion;
  ConsistencyCheck claims;  ///< no poses unless filled by checkConsistency()

  double percentOfPath(double length_m) const;
};

/// Compares an estimate with a reference. Remarks on the reliability of the results are added to
/// `diagnostics`. Throws InputError when the trajectories cannot be associated or aligned.
Evaluation evaluate(const Trajectory& estimate, const Trajectory& reference, const EvaluationOptions& options,
                    Diagnostics& diagnostics);

}  // namespace lodeline

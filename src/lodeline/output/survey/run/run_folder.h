#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/evaluation/trajectory/trajectory.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/output/survey/run/landmark_file.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Reported covariance of one position relative to the first, in the world of the run's trajectory.
struct PositionUncertainty {
  Time time;
  Mat3 covariance = Mat3::Zero();  ///< m^2
};

/// Results of `lodeline run` that a map needs.
struct RunFolder {
  std::filesystem::path folder;
  std::string trajectory_file;                     ///< name of the file of the poses
  Trajectory trajectory;                           ///< body in W
  std::vector<PositionUncertainty> uncertainties;  ///< in the order of time; empty where unknown
  std::vector<MapLandmark> landmarks;              ///< empty where there is no file of them
  HeadingReference heading_reference = HeadingReference::Start;
  std::optional<double> heading_sigma_rad;  ///< at the end
  std::string program;                      ///< "lodeline 0.1.0"
  std::string recording;                    ///< as the user named it
  std::optional<GeodeticPosition> site;     ///< if given to the run
  std::string date;                         ///< YYYY-MM-DD, if given to the run
  std::optional<double> depth_at_origin_m;  ///< of the first pose, where the run had a pressure sensor
  /// [phi, xi] (rad, m) of each camera of the run, as in factors/calibrated_reprojection_factor.h; empty
  /// where they were not estimated.
  std::vector<Eigen::Matrix<double, 6, 1>> camera_corrections;
  std::vector<Eigen::Matrix<double, 6, 1>>
      intrinsics_corrections;  ///< as in factors/intrinsics_factor.h; may be empty
};

/// Reads a run folder: poses from `trajectory_refined.tum` where it exists (with `states_refined.csv` and
/// `landmarks_refined.ply`), else from `trajectory.tum`. Other missing files are reported as findings. Throws
/// InputError where there are no poses, or a file is malformed.
RunFolder readRunFolder(const std::filesystem::path& folder, Diagnostics* diagnostics);

}  // namespace lodeline

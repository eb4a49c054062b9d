#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/output/report/blind_stretches.h"
#include "lodeline/output/report/sensor_frames.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Inputs of a run.
struct RunDescription {
  std::string version;  ///< of the program
  std::string data;     ///< as the user gave it
  std::string config;   ///< file of settings; empty for none
  std::vector<std::string> overrides;
  std::vector<std::string> cameras;  ///< names, the reference first
  double camera_rate_hz = 0.0;
  double imu_rate_hz = 0.0;
  Vec3 camera_axis_B = Vec3::UnitX();  ///< viewing direction of the reference camera
  std::vector<std::string> other_sensors;
  std::optional<Vec3> site_field_W;  ///< of the Earth, T, if the run was given its site
  std::optional<MagnetometerCalibration> magnetometer;
  double observation_sigma_px = 0.0;
};

class SummaryLines;

/// Collects the statistics of a run frame by frame.
class RunSummary {
 public:
  explicit RunSummary(const RunDescription& description = {}) : description_(description) {}

  void add(const FrameEstimate& estimate);

  int frames() const { return frames_; }
  int posed() const { return posed_; }
  const FrameEstimate& last() const { return last_; }

  // Set by the caller that runs the stages; processor seconds.
  double front_end_s = 0.0;
  double estimator_s = 0.0;
  double pictures_s = 0.0;  ///< for the report page
  double process_s = 0.0;   ///< of the whole process, all threads
  double wall_s = 0.0;
  double peak_memory_MB = 0.0;  ///< of the whole process
  int64_t images = 0;           ///< readable ones
  int64_t recorded_images = 0;  ///< of the first camera, including unusable ones
  int64_t map_points = 0;
  bool interrupted = false;                     ///< the user ended the run before the end of the recording
  std::optional<RefinementSummary> refinement;  ///< if the run was refined
  std::optional<MappingSummary> mapping;        ///< if the run made a map

  double recordingSeconds() const;
  /// Number of recorded images of the first camera; unusable ones are not frames.
  int64_t recorded() const { return std::max<int64_t>(recorded_images, frames_); }
  /// Share of the recorded images with an estimated pose. Frames that are propagated by inertial readings
  /// alone, or that contradict these, do not count.
  double completion() const {
    const int seen = posed_ - inertial_ - degraded_;
    return recorded() > 0 ? static_cast<double>(seen) / static_cast<double>(recorded()) : 0.0;
  }
  /// Reason not to trust the result: images and inertial readings contradicted each other in most frames or
  /// at the end. Empty otherwise.
  std::string distrust() const;
  double realTimeFactor() const { return wall_s > 0.0 ? recordingSeconds() / wall_s : 0.0; }
  double pathLength_m() const { return path_m_; }
  double meanTracks() const;
  double meanLandmarks() const;
  double meanReprojection_sigmas() const;

  /// Reports spans of at least half a second without usable images as the finding `blind_stretch`.
  void reportBlindStretches(Diagnostics* diagnostics) const;
  /// A few lines for people, then the findings; `with_details`: all values. `value_width`: of SummaryLines.
  std::string text(const Diagnostics& diagnostics, bool with_details = false, size_t value_width = 0) const;
  /// run.json: the same values and more in machine-readable form.
  std::string json(const Diagnostics& diagnostics) const;

 private:
  double coreMillisecondsPerFrame(double seconds) const;
  bool hasMagnetometer() const { return !magnetometer_frames_.empty(); }
  const MagnetometerEstimate& lastMagnetometer() const { return last_.sensors.of<MagnetometerEstimate>(); }
  const std::optional<DepthEstimate::Gauge>& lastGauge() const {
    return last_.sensors.of<DepthEstimate>().gauge;
  }
  double northFoundAfter_s() const;
  bool hasNorth() const;
  std::string completionText() const;
  std::string uncertaintyText() const;
  void addDetails(SummaryLines* lines) const;
  /// Replaces time stamps in a message by times since the first frame.
  std::string readable(const std::string& message) const;
  std::string headingText() const;
  std::string magnetometerText() const;
  std::string depthText() const;
  /// Mean of the scale information over the frames; empty without any.
  std::optional<ScaleInformation> scaleInformation() const;
  /// Processor time of the process outside front end, estimator and pictures: reading, decoding, writing.
  double filesSeconds() const { return process_s - front_end_s - estimator_s - pictures_s; }

  RunDescription description_;
  BlindStretches blind_;
  FrameEstimate last_;
  std::optional<Time> first_time_;
  Time first_pose_time_;
  std::optional<Vec3> last_position_W_;
  int frames_ = 0;
  int posed_ = 0;
  int inertial_ = 0;
  int degraded_ = 0;
  int disagreeing_ = 0;  ///< inertial although the images had enough tracks
  int keyframes_ = 0;
  double path_m_ = 0.0;
  double tracks_ = 0.0;
  double landmarks_ = 0.0;
  double reprojection_sigmas_ = 0.0;
  int reprojected_frames_ = 0;
  std::map<MagnetometerStatus, int> magnetometer_frames_;
  std::map<DepthStatus, int> depth_frames_;  ///< of frames with readings
  SensorFrames sensor_frames_;
  ScaleInformation scale_;  ///< summed over the frames
};

}  // namespace lodeline

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/inspection/survey/camera_survey.h"
#include "lodeline/inspection/survey/imu_survey.h"
#include "lodeline/inspection/survey/magnetometer_survey.h"
#include "lodeline/inspection/survey/stereo_survey.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Kind of the finding that the images' stamps are off the gyroscope's by a constant time.
inline constexpr const char* kCameraTimeOffset = "camera_time_offset";

/// One thing that is wrong with a recording, or worth knowing.
struct InspectionFinding {
  Severity severity = Severity::Notice;
  /// Orders findings of one severity: what spoils more, and what others follow from, is greater.
  double harm = 0.0;
  std::string sensor;   ///< "imu0", "cam0", …, "recording"
  std::string kind;     ///< stable identifier, e.g. "gyroscope_unit"
  std::string message;  ///< what was found, and what to do
};

/// A stream of which only the stamps are looked at.
struct PlainSurvey {
  std::string sensor;  ///< "pressure0", "sonar0"
  StreamSummary stream;
  double least = 0.0, greatest = 0.0;  ///< of the readings: depth or range, m
};

/// A camera with what its turns say of the rig.
struct CameraInspection {
  CameraSurvey survey;
  std::optional<TurnComparison> turning;
  std::optional<TurnComparison> turning_early, turning_late;  ///< of the first and second half of the turns
};

/// All that was found out about a recording.
struct Inspection {
  Rig rig;
  ImuSurvey imu;
  double rate_to_SI = 1.0;  ///< of the gyroscope, as far as it can be told; pi/180 where it is in deg/s
  WhiteNoise shown_noise;   ///< of the IMU, by its readings
  std::vector<CameraInspection> cameras;
  std::optional<StereoSurvey> stereo;  ///< of the first two cameras
  std::optional<MagnetometerSurvey> magnetometer;
  std::vector<PlainSurvey> others;
  std::optional<Vec3> site_field_W;         ///< east, north, up, T: where and when it was recorded, if told
  std::vector<InspectionFinding> findings;  ///< most harmful first

  /// "good", "usable" (there are warnings) or "harmful" (something is wrong).
  std::string verdict(const std::string& sensor) const;
};

struct InspectionOptions {
  CameraSurveyOptions images;
  double span_s = 4.0;  ///< of the stretches that are looked at closely
  std::optional<Vec3> site_field_W;
};

/// Opens the recording afresh; called more than once, as a source can be read but once.
using SourceFactory = std::function<std::unique_ptr<MeasurementSource>(Diagnostics* diagnostics)>;

/// Reads the whole recording, decodes some of its images, and judges. Throws InputError as the source does.
Inspection inspect(const SourceFactory& open, const InspectionOptions& options);

}  // namespace lodeline

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/imu/noise/vibration_survey.h"
#include "lodeline/inspection/robots/current_comparison.h"
#include "lodeline/inspection/robots/dvl_comparison.h"
#include "lodeline/inspection/robots/dvl_image_comparison.h"
#include "lodeline/inspection/survey/camera_survey.h"
#include "lodeline/inspection/survey/imu_survey.h"
#include "lodeline/inspection/survey/magnetometer_survey.h"
#include "lodeline/inspection/survey/stereo_survey.h"
#include "lodeline/io/robots/dvl_screen.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Kind of the finding that the images' time stamps have a constant offset to the gyroscope's.
inline constexpr const char* kCameraTimeOffset = "camera_time_offset";

/// Kind of the finding that the intrinsics of a camera are implausible.
inline constexpr const char* kIntrinsicsOdd = "intrinsics_odd";

/// One fault of a recording, or something worth knowing about it.
struct InspectionFinding {
  Severity severity = Severity::Notice;
  /// Rank of a finding among those of equal severity: larger for more harmful ones, and for causes of others.
  double harm = 0.0;
  std::string sensor;   ///< "imu0", "cam0", …, "recording"
  std::string kind;     ///< stable identifier, e.g. "gyroscope_unit"
  std::string message;  ///< the finding, and a recommendation
};

/// Range of one quantity of a stream.
struct ValueRange {
  std::string name;  ///< "depth", "v_x", or the name of a channel
  std::string unit;
  double least = 0.0, greatest = 0.0;
};

/// Survey of a stream of which only the time stamps and the range of the values are checked.
struct PlainSurvey {
  std::string sensor;  ///< "pressure0", "dvl0", …
  StreamSummary stream;
  std::vector<ValueRange> values;  ///< of quantities that have readings
  std::optional<DvlLock> lock;     ///< of a DVL
};

/// Survey of a camera, and the comparison of its rotations with the gyroscope.
struct CameraInspection {
  CameraSurvey survey;
  std::optional<TurnComparison> turning;
  std::optional<TurnComparison> turning_early, turning_late;  ///< from both halves of the rotations
};

/// Results of the inspection of a recording.
struct Inspection {
  Rig rig;
  ImuSurvey imu;
  double rate_to_SI = 1.0;                    ///< of the gyroscope, as far as it can be determined
  WhiteNoise shown_noise;                     ///< of the IMU, estimated from its readings
  Vibration force_vibration, rate_vibration;  ///< of accelerometer and gyroscope, SI units
  std::vector<CameraInspection> cameras;
  std::optional<StereoSurvey> stereo;  ///< of the first two cameras
  std::optional<MagnetometerSurvey> magnetometer;
  std::vector<PlainSurvey> others;
  std::optional<DvlComparison> dvl;              ///< with the IMU
  std::optional<DvlImageComparison> dvl_images;  ///< with the first camera
  std::optional<CurrentComparison> currents;     ///< with the magnetometer
  std::optional<Vec3> site_field_W;  ///< east, north, up, T: at the site and date of the recording, if known
  std::vector<InspectionFinding> findings;  ///< most harmful first

  /// "good", "usable" (there are warnings) or "harmful" (there are serious findings).
  std::string verdict(const std::string& sensor) const;
};

struct InspectionOptions {
  CameraSurveyOptions images;
  double span_s = 4.0;  ///< of the spans that are analysed in detail
  std::optional<Vec3> site_field_W;
  std::function<void(double share)> progress = [](double) {};  ///< takes the share of the work that is done
};

/// Opens the recording again; called more than once, because a source can be read only once.
using SourceFactory = std::function<std::unique_ptr<MeasurementSource>(Diagnostics* diagnostics)>;

/// Reads the whole recording, decodes some of its images, and evaluates them. Throws InputError as the source
/// does.
Inspection inspect(const SourceFactory& open, const InspectionOptions& options);

}  // namespace lodeline

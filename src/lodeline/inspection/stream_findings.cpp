#include <fmt/format.h>

#include "lodeline/inspection/findings.h"
#include "lodeline/io/streams/time_span.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline::findings {
namespace {

/// Largest share of faults in a stream that is not reported.
constexpr double kTolerableShare = 1e-3;
constexpr double kHarmfulImuGap_s = 0.05;

class StreamJudge {
 public:
  StreamJudge(const std::string& sensor, const StreamSummary& stream, bool is_imu, Inspection* inspection)
      : sensor_(sensor), stream_(stream), is_imu_(is_imu), inspection_(inspection) {}

  void judge() const {
    if (stream_.readings == 0) {
      add(Severity::Serious, 95.0, "stream_empty", "has no reading that could be used");
      return;
    }
    judgeOrder();
    judgeGaps();
    judgeFrozen();
  }

 private:
  void add(Severity severity, double harm, const std::string& kind, const std::string& message) const {
    inspection_->findings.push_back({severity, harm, sensor_, kind, message});
  }

  double share(int64_t count) const {
    return static_cast<double>(count) / static_cast<double>(stream_.readings);
  }

  void judgeOrder() const {
    const auto severity = [&](int64_t count) {
      if (share(count) > kTolerableShare) return is_imu_ ? Severity::Serious : Severity::Warning;
      return Severity::Notice;
    };
    if (stream_.duplicates > 0) {
      add(severity(stream_.duplicates), 60.0 + 10.0 * share(stream_.duplicates), "duplicate_stamps",
          fmt::format(
              "duplicated stamps: {} of {} readings ({:.2g} %) have the stamp of the one before and are "
              "dropped; look for a driver or merge that writes readings twice",
              stream_.duplicates, stream_.readings, 100.0 * share(stream_.duplicates)));
    }
    // Where a clock was set back, the order of the readings is correct.
    const int64_t backwards = stream_.backwards - stream_.clock_jumps;
    if (backwards > 0) {
      add(severity(backwards), 62.0 + 10.0 * share(backwards), "stamps_out_of_order",
          fmt::format("stamps out of order: time goes backwards {} times in {} readings ({:.2g} %), late "
                      "ones are dropped; sort the readings by their stamps",
                      backwards, stream_.readings, 100.0 * share(backwards)));
    }
  }

  void judgeGaps() const {
    if (stream_.gaps.empty()) return;
    const StreamGap& longest = stream_.gaps.front();
    // The usual interval between two readings is part of every gap.
    const double silent_s =
        stream_.gap_s - static_cast<double>(stream_.gaps.size()) / std::max(1e-9, stream_.rate_hz);
    const double lost = stream_.duration_s > 0.0 ? silent_s / stream_.duration_s : 0.0;
    const bool harmful = is_imu_ ? longest.length_s > kHarmfulImuGap_s || lost > 0.01 : lost > 0.1;
    add(harmful ? (is_imu_ ? Severity::Serious : Severity::Warning) : Severity::Notice,
        is_imu_ ? 64.0 + std::min(10.0, longest.length_s) : 40.0, "gaps",
        fmt::format("gaps: silent {} times, {:.3g} s together ({:.2g} % of the time), the longest {:.3g} s "
                    "after stamp "
                    "{} ns{}",
                    stream_.gaps.size(), silent_s, 100.0 * lost, longest.length_s,
                    longest.after.nanoseconds(),
                    harmful && is_imu_ ? "; motion within them is unknown" : ""));
  }

  void judgeFrozen() const {
    if (stream_.longest_frozen_s < 1.0) return;
    const bool mostly = stream_.frozen_share > 0.2;
    add(mostly || is_imu_ ? Severity::Serious : Severity::Warning, 70.0, "frozen",
        fmt::format(
            "frozen: says the same figures for {:.3g} s on end ({:.0f} % of the time); the sensor or its "
            "driver hangs",
            stream_.longest_frozen_s, 100.0 * stream_.frozen_share));
  }

  std::string sensor_;
  const StreamSummary& stream_;
  bool is_imu_;
  Inspection* inspection_;
};

/// Two sensors without readings at common times cannot be used together, however good each is.
class OverlapJudge {
 public:
  explicit OverlapJudge(Inspection* inspection) : inspection_(inspection) {}

  void judge(const std::string& sensor, const StreamSummary& stream, double time_offset_to_imu_s,
             const char* offset) const {
    judge(sensor, spanOf(stream, time_offset_to_imu_s), "imu0", spanOf(inspection_->imu.stream, 0.0), offset);
  }

  /// A camera by the clock of the first one is compared with the IMU, any other with the first one.
  void judgeCamera(size_t i) const {
    const auto spanOfCamera = [&](size_t camera) {
      return spanOf(inspection_->cameras[camera].survey.stream,
                    inspection_->rig.cameras[camera].time_offset_to_imu_s);
    };
    constexpr const char* kOffset =
        "timeshift_cam_imu (in s, to be added to the images' stamps; those above include its present value)";
    const std::string& name = inspection_->cameras[i].survey.name;
    const bool is_apart =
        i > 0 && judge(name, spanOfCamera(i), inspection_->cameras[0].survey.name, spanOfCamera(0), kOffset);
    if (!is_apart) judge(name, spanOfCamera(i), "imu0", spanOf(inspection_->imu.stream, 0.0), kOffset);
  }

 private:
  static std::optional<TimeSpan> spanOf(const StreamSummary& stream, double offset_s) {
    if (!stream.first || !stream.last) return std::nullopt;
    const Duration by = Duration::fromSeconds(offset_s);
    return TimeSpan{moved(*stream.first, by), moved(*stream.last, by)};
  }

  bool judge(const std::string& name, const std::optional<TimeSpan>& span, const std::string& other_name,
             const std::optional<TimeSpan>& other, const char* offset) const {
    if (!span || !other) return false;
    const std::optional<std::string> words = apart(name, *span, other_name, *other, offset);
    if (words) inspection_->findings.push_back({Severity::Serious, 100.0, "recording", kClocksApart, *words});
    return words.has_value();
  }

  Inspection* inspection_;
};

/// Reports missing sensors and what is impossible without them. Not all uses need all sensors.
void judgeAbsence(Inspection* inspection) {
  if (inspection->imu.stream.readings == 0) {
    inspection->findings.push_back(
        {inspection->cameras.empty() ? Severity::Warning : Severity::Serious, 95.0, "recording", "no_imu",
         "there are no inertial readings: a magnetometer may be calibrated with it, but neither attitude nor "
         "trajectory can be estimated"});
  }
  if (inspection->cameras.empty()) {
    inspection->findings.push_back({Severity::Notice, 0.0, "recording", "no_images",
                                    "there are no images: no trajectory can be estimated (lodeline run), but "
                                    "attitude, noise and the magnetometer's calibration"});
  }
}

}  // namespace

void judgeStreams(Inspection* inspection) {
  judgeAbsence(inspection);
  const OverlapJudge overlap(inspection);
  for (size_t i = 0; i < inspection->cameras.size(); ++i) overlap.judgeCamera(i);
  if (inspection->magnetometer)
    overlap.judge("mag0", inspection->magnetometer->stream,
                  inspection->rig.magnetometer->time_offset_to_imu_s,
                  "time_offset_to_imu_s of its calibration");
  const Rig& rig = inspection->rig;
  for (const PlainSurvey& other : inspection->others) {
    const double dvl_s = other.sensor == "dvl0" ? rig.dvl->time_offset_to_imu_s : 0.0;
    const double current_s = other.sensor == "current0" ? rig.currents->time_offset_to_imu_s : 0.0;
    overlap.judge(other.sensor, other.stream, dvl_s + current_s, "its clock");
  }
  if (inspection->imu.stream.readings > 0) {
    StreamJudge("imu0", inspection->imu.stream, true, inspection).judge();
  }
  for (const CameraInspection& camera : inspection->cameras) {
    StreamJudge(camera.survey.name, camera.survey.stream, false, inspection).judge();
  }
  if (inspection->magnetometer)
    StreamJudge("mag0", inspection->magnetometer->stream, false, inspection).judge();
  for (const PlainSurvey& other : inspection->others) {
    // Depth and range may be constant for a while.
    StreamSummary stream = other.stream;
    stream.longest_frozen_s = 0.0;
    StreamJudge(other.sensor, stream, false, inspection).judge();
  }
}

}  // namespace lodeline::findings

#include "lodeline/output/report/run_summary.h"

#include <fmt/format.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "lodeline/output/files/world_turn.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/report/readable_times.h"
#include "lodeline/output/report/stage_summaries.h"
#include "lodeline/output/report/summary_lines.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

/// Number of tracks in an image with sufficient texture.
constexpr int kManyTracks = 30;

nlohmann::ordered_json rigJson(const RunDescription& run) {
  const Vec3& axis = run.camera_axis_B;
  nlohmann::ordered_json json = {{"cameras", run.cameras},
                                 {"camera_rate_hz", run.camera_rate_hz},
                                 {"camera_axis_B", {axis.x(), axis.y(), axis.z()}},
                                 {"imu_rate_hz", run.imu_rate_hz},
                                 {"other_sensors", run.other_sensors}};
  if (run.magnetometer) {
    json["magnetometer"]["is_calibrated"] = run.magnetometer->is_calibrated;
    if (run.magnetometer->field_strength_T)
      json["magnetometer"]["field_strength_T"] = *run.magnetometer->field_strength_T;
    if (run.site_field_W) json["magnetometer"]["site_field_strength_T"] = run.site_field_W->norm();
  }
  return json;
}

nlohmann::ordered_json toJson(const RunDescription& run) {
  return {{"program", "lodeline " + run.version},
          {"data", run.data},
          {"config", run.config},
          {"settings_from_command_line", run.overrides},
          {"rig", rigJson(run)}};
}

std::string describe(const char* sensor, const SensorAxes& axes) {
  const Mat3 errors = axes.reshaped(3, 3);
  const Mat3 aside = errors - Mat3(errors.diagonal().asDiagonal());
  return fmt::format("axes of the {} {:+.2f} {:+.2f} {:+.2f} %, aside by up to {:.2f} deg off the files",
                     sensor, 100.0 * errors(0, 0), 100.0 * errors(1, 1), 100.0 * errors(2, 2),
                     aside.cwiseAbs().maxCoeff() * 180.0 / M_PI);
}

/// I + D, row by row.
nlohmann::ordered_json toJson(const SensorAxes& axes) {
  const Mat3 matrix = Mat3::Identity() + axes.reshaped(3, 3);
  nlohmann::ordered_json rows;
  for (int row = 0; row < 3; ++row) rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2)});
  return rows;
}

nlohmann::ordered_json toJson(const DepthEstimate::Gauge& gauge) {
  return {{"depth_at_origin_m", gauge.depth_at_origin_m},
          {"density_ratio", gauge.density_ratio},
          {"density_ratio_sigma", gauge.density_ratio_sigma},
          {"lag_s", gauge.lag_s},
          {"lag_sigma_s", gauge.lag_sigma_s}};
}

using ScaleSource = std::pair<const char*, double ScaleInformation::*>;
constexpr ScaleSource kScaleSources[] = {{"stereo", &ScaleInformation::stereo},
                                         {"accelerometer", &ScaleInformation::accelerometer},
                                         {"depth", &ScaleInformation::depth},
                                         {"dvl", &ScaleInformation::dvl}};

std::string describe(const ScaleInformation& scale) {
  std::string text = "carried";
  for (const auto& [name, source] : kScaleSources) {
    const double information = scale.*source;
    if (information > 0.0)
      text += fmt::format(" {:.0f} % by {} (alone {:.1f} %),", 100.0 * information / scale.sum(), name,
                          100.0 / std::sqrt(information));
  }
  return text +
         fmt::format(" together {:.1f} % (one sigma over half a minute)", 100.0 / std::sqrt(scale.sum()));
}

nlohmann::ordered_json toJson(const ScaleInformation& scale) {
  nlohmann::ordered_json json;
  json["sigma"] = 1.0 / std::sqrt(scale.sum());
  for (const auto& [name, source] : kScaleSources) {
    const double information = scale.*source, others = scale.sum() - information;
    json[name]["share"] = information / scale.sum();
    if (information > 0.0) json[name]["sigma_alone"] = 1.0 / std::sqrt(information);
    if (others > 0.0) json[name]["sigma_without"] = 1.0 / std::sqrt(others);
  }
  return json;
}

}  // namespace

void RunSummary::add(const FrameEstimate& estimate) {
  ++frames_;
  if (!first_time_) first_time_ = estimate.time;
  last_ = estimate;
  blind_.add(estimate);
  if (estimate.status == Status::Waiting) return;
  if (posed_ == 0) first_pose_time_ = estimate.time;
  ++posed_;
  inertial_ += estimate.status == Status::Inertial;
  degraded_ += estimate.status == Status::Degraded;
  disagreeing_ += estimate.status == Status::Inertial && estimate.tracks >= kManyTracks;
  keyframes_ += estimate.is_keyframe;
  const MagnetometerStatus magnetometer = estimate.sensors.of<MagnetometerEstimate>().status;
  if (magnetometer != MagnetometerStatus::Off) ++magnetometer_frames_[magnetometer];
  const DepthStatus depth = estimate.sensors.of<DepthEstimate>().status;
  if (depth != DepthStatus::Off && depth != DepthStatus::NoData) ++depth_frames_[depth];
  sensor_frames_.add(estimate.sensor_rows);
  for (const auto& [name, source] : kScaleSources) scale_.*source += estimate.scale.*source;
  const Vec3& position_W = estimate.state.world_from_body.translation;
  if (last_position_W_) path_m_ += (position_W - *last_position_W_).norm();
  last_position_W_ = position_W;
  tracks_ += estimate.tracks;
  landmarks_ += estimate.landmarks;
  if (estimate.landmarks > 0) {
    reprojection_sigmas_ += estimate.reprojection_rms_sigmas;
    ++reprojected_frames_;
  }
}

std::string RunSummary::distrust() const {
  const int contradicted = degraded_ + disagreeing_;
  const bool at_the_end = last_.status == Status::Degraded;
  if (!at_the_end && 2 * contradicted <= posed_) return {};
  return fmt::format("images and inertial readings contradict each other in {} of {} frames{}", contradicted,
                     posed_, at_the_end ? ", the last among them" : "");
}

void RunSummary::reportBlindStretches(Diagnostics* diagnostics) const {
  constexpr double kLeast_s = 0.5;
  if (first_time_) blind_.report(*first_time_, kLeast_s, diagnostics);
}

double RunSummary::recordingSeconds() const {
  return first_time_ ? (last_.time - *first_time_).seconds() : 0.0;
}
double RunSummary::meanTracks() const { return posed_ ? tracks_ / posed_ : 0.0; }
double RunSummary::meanLandmarks() const { return posed_ ? landmarks_ / posed_ : 0.0; }
double RunSummary::meanReprojection_sigmas() const {
  return reprojected_frames_ ? reprojection_sigmas_ / reprojected_frames_ : 0.0;
}
double RunSummary::coreMillisecondsPerFrame(double seconds) const {
  return frames_ ? 1e3 * seconds / frames_ : 0.0;
}

double RunSummary::northFoundAfter_s() const {
  return (*lastMagnetometer().north_found - first_pose_time_).seconds();
}

bool RunSummary::hasNorth() const { return WorldTurn::of(lastMagnetometer()).has_value(); }

std::string RunSummary::headingText() const {
  const double found_after_s = northFoundAfter_s();
  const std::string late =
      found_after_s > 0.0 ? fmt::format(" found {:.1f} s after the first pose", found_after_s) : "";
  return fmt::format("{}{}; all files are turned by {:.1f} deg to it",
                     toString(lastMagnetometer().heading_reference), late,
                     WorldTurn::of(lastMagnetometer())->angle_rad * 180.0 / M_PI);
}

std::string RunSummary::magnetometerText() const {
  std::string text;
  int believed = 0;
  for (const auto& [status, frames] : magnetometer_frames_) {
    text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", toString(status), 100.0 * frames / posed_);
    if (status == MagnetometerStatus::Used) believed += frames;
  }
  if (2 * believed < posed_) text += "; heading owes little to it, check calibration and surroundings";
  return text;
}

std::string RunSummary::depthText() const {
  std::string text;
  for (const auto& [status, frames] : depth_frames_)
    text += fmt::format("{}{} {} readings", text.empty() ? "" : ", ", frames, toString(status));
  if (!lastGauge()) return text;
  const DepthEstimate::Gauge& gauge = *lastGauge();
  return text + fmt::format("; {:.2f} m at the origin, density ratio {:.4f} (sigma {:.4f}), lag {:.2f} s",
                            gauge.depth_at_origin_m, gauge.density_ratio, gauge.density_ratio_sigma,
                            gauge.lag_s);
}

std::optional<ScaleInformation> RunSummary::scaleInformation() const {
  if (!(scale_.sum() > 0.0)) return std::nullopt;
  ScaleInformation mean = scale_;
  for (const auto& [name, source] : kScaleSources) mean.*source /= posed_;
  return mean;
}

std::string RunSummary::completionText() const {
  std::string text = fmt::format("{:.1f} % ({} of {} images were tracked", 100.0 * completion(),
                                 posed_ - inertial_ - degraded_, recorded());
  if (inertial_ > 0) text += fmt::format("; {} poses by inertial readings alone", inertial_);
  if (degraded_ > 0) text += fmt::format("; {} degraded", degraded_);
  return text + ")";
}

std::string RunSummary::uncertaintyText() const {
  const Eigen::VectorXd sigma = last_.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return fmt::format(
      "{:.3f} m, heading {:.2f} deg against the first pose, {:.2f} deg against {} (one sigma, at the end)",
      sigma.head<3>().norm(), sigma[5] * 180.0 / M_PI, lastMagnetometer().heading_sigma_rad * 180.0 / M_PI,
      toString(lastMagnetometer().heading_reference));
}

void RunSummary::addDetails(SummaryLines* lines) const {
  lines->add("map", fmt::format("{} keyframes, {} landmarks; {:.0f} of {:.0f} tracks a frame are landmarks",
                                keyframes_, map_points, meanLandmarks(), meanTracks()));
  if (last_.camera_corrections) lines->add("calibration", describe(*last_.camera_corrections));
  if (last_.gyroscope_axes) lines->add("inertial", describe("gyroscope", *last_.gyroscope_axes));
  if (last_.accelerometer_axes) lines->add("inertial", describe("accelerometer", *last_.accelerometer_axes));
  if (hasMagnetometer()) lines->add("magnetometer", magnetometerText());
  if (!depth_frames_.empty()) lines->add("pressure", depthText());
  sensor_frames_.describe(lines);
  if (const auto scale = scaleInformation()) lines->add("scale", describe(*scale));
  lines->add(
      "time",
      fmt::format(
          "{:.1f} s; core-ms a frame: files {:.1f}, front end {:.1f}, estimator {:.1f}, pictures {:.1f}",
          wall_s, coreMillisecondsPerFrame(filesSeconds()), coreMillisecondsPerFrame(front_end_s),
          coreMillisecondsPerFrame(estimator_s), coreMillisecondsPerFrame(pictures_s)));
}

std::string RunSummary::text(const Diagnostics& diagnostics, bool with_details, size_t value_width) const {
  SummaryLines lines(value_width);
  if (const std::string reason = distrust(); !reason.empty()) lines.add("do not trust", reason);
  if (refinement) lines.add("refinement", describe(*refinement));
  if (mapping && (mapping->accepted > 0 || !mapping->is_placed)) lines.add("loops", describe(*mapping));
  lines.add("completion", completionText());
  lines.add("path", fmt::format("{:.2f} m in {}", path_m_, clockText(recordingSeconds())));
  if (posed_ > 0) lines.add("uncertainty", uncertaintyText());
  if (posed_ > 0 && hasNorth()) lines.add("heading", headingText());
  lines.add("images", fmt::format("{:.0f} tracks a frame, {:.2f} px rms ({:.2f} sigma)", meanTracks(),
                                  meanReprojection_sigmas() * description_.observation_sigma_px,
                                  meanReprojection_sigmas()));
  lines.add("cost", fmt::format("{:.1f} core-ms a frame, {:.1f} x real time, {:.0f} MB",
                                coreMillisecondsPerFrame(process_s), realTimeFactor(), peak_memory_MB));
  if (with_details) addDetails(&lines);
  if (interrupted) lines.add("interrupted", "the recording goes on; results cover what was read");
  for (const Finding& finding : diagnostics.ranked()) {
    const std::string times = finding.count > 1 ? fmt::format(" ({} times)", finding.count) : "";
    lines.add(toString(finding.severity), readable(finding.first_message) + times);
  }
  return lines.text();
}

std::string RunSummary::readable(const std::string& message) const {
  return first_time_ ? withReadableTimes(message, *first_time_) : message;
}

std::string RunSummary::json(const Diagnostics& diagnostics) const {
  nlohmann::ordered_json json = toJson(description_);
  json["interrupted"] = interrupted;
  if (first_time_) json["first_frame_ns"] = std::to_string(first_time_->nanoseconds());
  json["frames"] = frames_;
  json["images_recorded"] = recorded();
  json["frames_with_pose"] = posed_;
  json["frames_inertial"] = inertial_;
  json["frames_degraded"] = degraded_;
  if (const std::string reason = distrust(); !reason.empty()) json["do_not_trust"] = reason;
  json["blind_stretches"] = nlohmann::ordered_json::array();
  for (const BlindStretch& stretch : blind_.stretches()) {
    json["blind_stretches"].push_back({{"start_ns", std::to_string(stretch.start.nanoseconds())},
                                       {"duration_s", stretch.seconds()},
                                       {"sigma_start_m", stretch.sigma_start_m},
                                       {"sigma_end_m", stretch.sigma_end_m}});
  }
  if (posed_ == 0) json["waiting_for"] = last_.waiting_for;
  json["images"] = images;
  json["keyframes"] = keyframes_;
  json["completion"] = completion();
  json["path_m"] = path_m_;
  json["duration_s"] = recordingSeconds();
  json["landmarks"] = map_points;
  json["mean_tracks"] = meanTracks();
  json["mean_landmarks"] = meanLandmarks();
  json["mean_reprojection_rms_px"] = meanReprojection_sigmas() * description_.observation_sigma_px;
  json["mean_reprojection_rms_sigmas"] = meanReprojection_sigmas();
  if (last_.camera_corrections) json["camera_corrections"] = toJson(*last_.camera_corrections);
  if (last_.gyroscope_axes) json["gyroscope_true_from_reading"] = toJson(*last_.gyroscope_axes);
  if (last_.accelerometer_axes) json["accelerometer_true_from_reading"] = toJson(*last_.accelerometer_axes);
  json["wall_s"] = wall_s;
  json["real_time_factor"] = realTimeFactor();
  json["core_ms_per_frame"] = {{"total", coreMillisecondsPerFrame(process_s)},
                               {"files", coreMillisecondsPerFrame(filesSeconds())},
                               {"front_end", coreMillisecondsPerFrame(front_end_s)},
                               {"estimator", coreMillisecondsPerFrame(estimator_s)},
                               {"pictures", coreMillisecondsPerFrame(pictures_s)}};
  json["peak_memory_MB"] = peak_memory_MB;
  const MagnetometerEstimate& magnetometer = lastMagnetometer();
  json["heading"] = {{"reference", toString(magnetometer.heading_reference)},
                     {"sigma_rad", magnetometer.heading_sigma_rad}};
  const std::optional<WorldTurn> turn = WorldTurn::of(magnetometer);
  if (turn) {
    json["heading"]["north_found_after_s"] = northFoundAfter_s();
    json["heading"]["world_turned_rad"] = turn->angle_rad;
  }
  if (hasMagnetometer()) {
    for (const auto& [status, frames] : magnetometer_frames_)
      json["magnetometer"]["frames"][toString(status)] = frames;
  }
  if (magnetometer.field_W) {
    const Vec3 field = turn ? turn->apply(*magnetometer.field_W) : *magnetometer.field_W;
    const Vec3& offset = *magnetometer.offset_B;
    json["magnetometer"]["field_W_T"] = {field.x(), field.y(), field.z()};
    json["magnetometer"]["offset_B_T"] = {offset.x(), offset.y(), offset.z()};
    json["magnetometer"]["correlated_noise_sigma_T"] = *magnetometer.correlated_noise_sigma_T;
  }
  for (const auto& [status, frames] : depth_frames_) json["pressure"]["frames"][toString(status)] = frames;
  if (lastGauge()) json["pressure"]["gauge"] = toJson(*lastGauge());
  sensor_frames_.addTo(&json);
  if (const auto scale = scaleInformation()) json["scale"] = toJson(*scale);
  if (refinement) json["refinement"] = toJson(*refinement);
  if (mapping) json["mapping"] = toJson(*mapping);
  json["findings"] = findingsJson(diagnostics, [this](const std::string& m) { return readable(m); });
  return jsonText(json) + "\n";
}

}  // namespace lodeline

#include "lodeline/output/report/stage_summaries.h"

#include <fmt/format.h>

#include <cmath>

namespace lodeline {
namespace {

/// Changes of the ports with their claimed errors.
std::string describePorts(const std::vector<PortCorrection>& ports) {
  std::string text;
  for (size_t i = 0; i < ports.size(); ++i) {
    const PortCorrection& port = ports[i];
    text += fmt::format(", port {}", i);
    for (const int axis : {0, 1, 2}) {
      const bool is_turn = axis < 2 && !port.is_dome;
      const double unit = is_turn ? 180.0 / M_PI : 1e3;
      text += fmt::format(" {:+.2f} ± {:.2f} {}", unit * port.change[axis], unit * port.sigma[axis],
                          is_turn ? "deg" : "mm");
    }
  }
  return text;
}

}  // namespace

std::string describe(const CameraCorrections& corrections) {
  std::string text = fmt::format("images {:+.1f} ms", 1e3 * corrections.time_offset_s);
  for (const double line_delay_s : corrections.line_delays_s)
    text += fmt::format(", {:.2f} us a row", 1e6 * line_delay_s);
  for (size_t i = 0; i < corrections.extrinsics.size(); ++i) {
    const auto& extrinsics = corrections.extrinsics[i];
    text += fmt::format(", camera {}{} {:.2f} deg {:.1f} mm", i, i > 0 ? " to camera 0" : "",
                        extrinsics.head<3>().norm() * 180.0 / M_PI, 1e3 * extrinsics.tail<3>().norm());
  }
  if (corrections.are_files_held)
    return text + (corrections.extrinsics.size() > 1
                       ? " off the files; lenses and camera 1's turn as they say"
                       : " off the files; lens as they say");
  for (size_t i = 0; i < corrections.intrinsics.size(); ++i) {
    const auto& lens = corrections.intrinsics[i];
    text += fmt::format(", lens {} focal length {:+.2f} % {:+.2f} %, centre {:+.1f} {:+.1f} px", i,
                        100.0 * lens[0], 100.0 * lens[1], lens[2], lens[3]);
  }
  return text + " off the files";
}

nlohmann::ordered_json toJson(const CameraCorrections& corrections) {
  nlohmann::ordered_json json;
  json["time_offset_s"] = corrections.time_offset_s;
  json["are_files_held"] = corrections.are_files_held;
  if (!corrections.line_delays_s.empty()) json["line_delays_s"] = corrections.line_delays_s;
  for (const auto& extrinsics : corrections.extrinsics) {
    json["cameras"].push_back({{"rotation_rad", {extrinsics[0], extrinsics[1], extrinsics[2]}},
                               {"position_m", {extrinsics[3], extrinsics[4], extrinsics[5]}}});
  }
  for (size_t i = 0; i < corrections.intrinsics.size(); ++i) {
    const auto& lens = corrections.intrinsics[i];
    json["cameras"][i]["focal_length"] = {lens[0], lens[1]};
    json["cameras"][i]["principal_point_px"] = {lens[2], lens[3]};
    json["cameras"][i]["radial"] = {lens[4], lens[5]};
    json["cameras"][i]["tangential"] = {lens[6], lens[7]};
    json["cameras"][i]["port_tilt"] = {lens[8], lens[9]};
  }
  for (size_t i = 0; i < corrections.ports.size(); ++i) {
    const PortCorrection& port = corrections.ports[i];
    json["cameras"][i]["port_change"] = {port.change[0], port.change[1], port.change[2]};
    json["cameras"][i]["port_sigma"] = {port.sigma[0], port.sigma[1], port.sigma[2]};
  }
  return json;
}

std::string describe(const RefinementSummary& refined) {
  if (!refined.usable()) return "refused: " + refined.refusal + "; the forward run is what there is";
  return fmt::format(
      "{} states, {} landmarks, {} observations ({:.1f} % left out, {:.1f} of them count as one), {} "
      "steps{}; "
      "cost {:.4g} of {:.4g}; moved "
      "by "
      "{:.3f} m and {:.2f} deg rms, {:.3f} m at most{}; {:.1f} core-s",
      refined.states, refined.landmarks, refined.observations, 100.0 * refined.outlier_share,
      refined.design_effect, refined.iterations, refined.converged ? "" : " (not converged)",
      refined.first_round_cost, refined.forward_cost, refined.moved_rms_m,
      refined.turned_rms_rad * 180.0 / M_PI, refined.moved_max_m,
      refined.camera_corrections ? describePorts(refined.camera_corrections->ports) : "",
      refined.processor_s);
}

nlohmann::ordered_json toJson(const RefinementSummary& refined) {
  nlohmann::ordered_json json;
  json["used"] = refined.usable();
  if (!refined.usable()) json["refusal"] = refined.refusal;
  json["converged"] = refined.converged;
  json["states"] = refined.states;
  json["landmarks"] = refined.landmarks;
  json["observations"] = refined.observations;
  json["observation_variance"] = refined.observation_variance;
  json["design_effect"] = refined.design_effect;
  json["outlier_share"] = refined.outlier_share;
  json["iterations"] = refined.iterations;
  json["cost"] = {
      {"forward", refined.forward_cost}, {"first_round", refined.first_round_cost}, {"end", refined.cost}};
  json["moved_rms_m"] = refined.moved_rms_m;
  json["moved_max_m"] = refined.moved_max_m;
  json["turned_rms_rad"] = refined.turned_rms_rad;
  json["end_sigma_m"] = {{"forward", refined.forward_sigma_m}, {"refined", refined.sigma_m}};
  json["has_covariance"] = refined.has_covariance;
  if (refined.camera_corrections) json["camera_corrections"] = toJson(*refined.camera_corrections);
  json["processor_s"] = refined.processor_s;
  return json;
}

std::string describe(const MappingSummary& mapping) {
  const int within = mapping.accepted - mapping.accepted_between_dives;
  std::string text = fmt::format("{} within the dive", within);
  if (mapping.accepted_between_dives > 0)
    text += fmt::format(", {} with earlier dives", mapping.accepted_between_dives);
  if (!mapping.is_placed) text += "; no place of the earlier map was recognized";
  return text +
         fmt::format(" ({} pairs of images compared); trajectory_map.tum closes them", mapping.candidates);
}

nlohmann::ordered_json toJson(const MappingSummary& mapping) {
  return {{"keyframes", mapping.keyframes},
          {"loops",
           {{"candidates", mapping.candidates},
            {"verified", mapping.verified},
            {"accepted", mapping.accepted},
            {"refused", mapping.refused},
            {"accepted_between_dives", mapping.accepted_between_dives}}},
          {"is_placed", mapping.is_placed},
          {"processor_s", mapping.processor_s}};
}

}  // namespace lodeline

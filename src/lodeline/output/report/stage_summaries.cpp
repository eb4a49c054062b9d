#include "lodeline/output/report/stage_summaries.h"

#include <fmt/format.h>

#include <cmath>

namespace lodeline {

std::string describe(const RefinementSummary& refined) {
  if (!refined.usable()) return "refused: " + refined.refusal + "; the forward run is what there is";
  return fmt::format(
      "{} states, {} landmarks, {} observations ({:.1f} % left out, {:.1f} of them count as one), {} "
      "steps{}; "
      "cost {:.4g} of {:.4g}; moved "
      "by "
      "{:.3f} m and {:.2f} deg rms, {:.3f} m at most; {:.1f} core-s",
      refined.states, refined.landmarks, refined.observations, 100.0 * refined.outlier_share,
      refined.design_effect, refined.iterations, refined.converged ? "" : " (not converged)",
      refined.first_round_cost, refined.forward_cost, refined.moved_rms_m,
      refined.turned_rms_rad * 180.0 / M_PI, refined.moved_max_m, refined.processor_s);
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

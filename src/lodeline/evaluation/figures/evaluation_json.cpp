#include "lodeline/evaluation/figures/evaluation_report.h"

namespace lodeline {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Statistics& s) {
  return {{"count", s.count},
          {"rmse", s.rmse},
          {"mean", s.mean},
          {"median", s.median},
          {"std", s.std},
          {"min", s.min},
          {"lower_quartile", s.lower_quartile},
          {"upper_quartile", s.upper_quartile},
          {"max", s.max}};
}

Json toJson(const RelativeErrors& r) {
  return {{"length_m", r.length_m},
          {"translation_m", toJson(computeStatistics(r.translation_m))},
          {"translation_percent", toJson(computeStatistics(r.translation_percent))},
          {"rotation_deg", toJson(computeStatistics(r.rotation_deg))},
          {"rotation_deg_per_m", toJson(computeStatistics(r.rotation_deg_per_m))},
          {"yaw_deg", toJson(computeStatistics(r.yaw_deg))}};
}

Json toJson(const Alignment& alignment, AlignmentType type) {
  const Quat& q = alignment.reference_from_estimate.rotation;
  const Vec3& t = alignment.reference_from_estimate.translation;
  return {{"type", toString(type)},
          {"scale", alignment.scale},
          {"scale_error_percent", 100.0 * alignment.scaleError()},
          {"reference_from_estimate_quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"reference_from_estimate_translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_from_orientations", alignment.rotation_from_orientations}};
}

Json toJson(const Completion& completion) {
  Json json = {{"percent", 100.0 * completion.share}, {"basis", completion.by_images ? "images" : "time"}};
  if (completion.by_images) {
    json["images_expected"] = completion.expected;
    json["images_estimated"] = completion.estimated;
  }
  return json;
}

Json toJson(const Diagnostics& diagnostics) {
  Json list = Json::array();
  for (const Finding& finding : diagnostics.ranked()) {
    list.push_back({{"severity", toString(finding.severity)},
                    {"kind", finding.kind},
                    {"count", finding.count},
                    {"message", finding.first_message}});
  }
  return list;
}

Json toJson(const Vec3& axes) { return {axes.x(), axes.y(), axes.z()}; }

Json toJson(const ReportedAxes& axes) {
  return {{"within_3_sigma_percent", toJson(axes.within_3_sigma_percent)},
          {"rms_sigmas", toJson(axes.rms_sigmas)}};
}

}  // namespace

Json evaluationJson(const Evaluation& e, const Diagnostics& diagnostics) {
  const AssociationOptions& association = e.options.association;
  Json json;
  json["estimate"] = {{"name", e.estimate.name}, {"poses", e.estimate.size()}, {"path_m", e.estimate_path_m}};
  json["reference"] = {
      {"name", e.reference.name}, {"poses", e.reference.size()}, {"path_m", e.reference_path_m}};
  json["association"] = {
      {"pairs", e.pairs.size()},
      {"method", association.method == AssociationMethod::Nearest ? "nearest" : "interpolate"},
      {"tolerance_s", association.tolerance_s},
      {"time_offset_s", association.time_offset_s}};
  if (e.reference.time_base == TimeBase::Stamps) {
    json["association"]["span_s"] = (e.pairs.time.back() - e.pairs.time.front()).seconds();
  }
  json["alignment"] = toJson(e.alignment, e.options.alignment);
  json["completion"] = toJson(e.completion);
  json["absolute"] = {{"position_m", toJson(e.absolute.position())},
                      {"rotation_deg", toJson(e.absolute.rotation())},
                      {"yaw_deg", toJson(e.absolute.yaw())}};
  json["relative_consecutive"] = e.consecutive.size() > 0 ? toJson(e.consecutive) : Json();
  json["relative"] = Json::array();
  for (const RelativeErrors& r : e.relative) json["relative"].push_back(toJson(r));
  json["end_point"] = {{"after_alignment_m", e.end_point_m},
                       {"after_alignment_percent", e.percentOfPath(e.end_point_m)},
                       {"from_equal_starts_m", e.drift_m},
                       {"from_equal_starts_percent", e.percentOfPath(e.drift_m)}};
  if (e.claims.poses > 0) {
    json["claims"] = {{"poses", e.claims.poses},
                      {"heading_from", toString(e.claims.basis)},
                      {"position", toJson(e.claims.position)},
                      {"rotation", toJson(e.claims.rotation)}};
  }
  json["remarks"] = toJson(diagnostics);
  return json;
}

}  // namespace lodeline

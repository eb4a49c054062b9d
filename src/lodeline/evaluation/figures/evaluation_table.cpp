#include <fmt/format.h>

#include "lodeline/evaluation/figures/evaluation_report.h"

namespace lodeline {
namespace {

std::string alignmentText(const Evaluation& e) {
  const std::size_t used = e.options.alignment_pairs;
  std::string text = toString(e.options.alignment);
  if (e.options.alignment == AlignmentType::None) return text;
  text += used > 0 && used < e.pairs.size() ? fmt::format(", on the first {} pairs", used) : ", on all pairs";
  if (e.options.alignment == AlignmentType::Sim3) {
    const double error_percent = 100.0 * e.alignment.scaleError();
    text += fmt::format(", scale {:.6f} (estimate {:.2f} % too {})", e.alignment.scale,
                        std::abs(error_percent), error_percent >= 0.0 ? "large" : "small");
  }
  return text;
}

std::string completionText(const Completion& completion, TimeBase time_base) {
  if (!completion.by_images) {
    return fmt::format("{:.2f} % of the reference's {}", 100.0 * completion.share,
                       time_base == TimeBase::Index ? "rows" : "time");
  }
  return fmt::format("{:.2f} % ({} of {} images)", 100.0 * completion.share, completion.estimated,
                     completion.expected);
}

std::string overview(const Evaluation& e) {
  const double span_s = (e.pairs.time.back() - e.pairs.time.front()).seconds();
  const bool by_index = e.reference.time_base == TimeBase::Index;
  std::string text;
  text += fmt::format("estimate    {} ({} poses)\n", e.estimate.name, e.estimate.size());
  text += fmt::format("reference   {} ({} poses)\n", e.reference.name, e.reference.size());
  text += by_index ? fmt::format("pairs       {}, by row\n", e.pairs.size())
                   : fmt::format("pairs       {} over {:.2f} s\n", e.pairs.size(), span_s);
  text += fmt::format("alignment   {}\n", alignmentText(e));
  text += fmt::format("path        reference {:.3f} m, estimate {:.3f} m\n", e.reference_path_m,
                      e.estimate_path_m);
  text += fmt::format("completion  {}\n", completionText(e.completion, e.reference.time_base));
  return text;
}

std::string absoluteRow(const char* name, const Statistics& s) {
  return fmt::format("  {:<16}{:>11.5f}{:>11.5f}{:>11.5f}{:>11.5f}{:>11.5f}{:>11.5f}\n", name, s.rmse, s.mean,
                     s.median, s.std, s.min, s.max);
}

std::string absoluteTable(const Evaluation& e) {
  std::string text = fmt::format("  {:<16}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "", "rmse", "mean",
                                 "median", "std", "min", "max");
  text += absoluteRow("position (m)", e.absolute.position());
  text += absoluteRow("rotation (deg)", e.absolute.rotation());
  text += absoluteRow("yaw (deg)", e.absolute.yaw());
  return "absolute trajectory error\n" + text;
}

std::string consecutiveTable(const Evaluation& e) {
  if (e.consecutive.size() == 0) return "";
  std::string text = fmt::format("relative pose error, {:g} m, {} consecutive stretches\n",
                                 e.consecutive.length_m, e.consecutive.size());
  text += fmt::format("  {:<16}{:>11}{:>11}{:>11}{:>11}{:>11}{:>11}\n", "", "rmse", "mean", "median", "std",
                      "min", "max");
  text += absoluteRow("position (m)", computeStatistics(e.consecutive.translation_m));
  text += absoluteRow("rotation (deg)", computeStatistics(e.consecutive.rotation_deg));
  return text;
}

std::string medianAndQuartiles(const std::vector<double>& values) {
  const Statistics s = computeStatistics(values);
  return fmt::format("{:.3f} [{:.3f} {:.3f}]", s.median, s.lower_quartile, s.upper_quartile);
}

std::string relativeTable(const Evaluation& e) {
  if (e.relative.empty()) return "";
  std::string text = "relative errors over stretches of the path: median [quartiles]\n";
  text += fmt::format("  {:>10} {:>7}{:>25}{:>25}{:>25}{:>25}\n", "length (m)", "count", "position (m)",
                      "position (%)", "rotation (deg)", "yaw (deg)");
  for (const RelativeErrors& r : e.relative) {
    text += fmt::format("  {:>10.2f} {:>7}{:>25}{:>25}{:>25}{:>25}\n", r.length_m, r.size(),
                        medianAndQuartiles(r.translation_m), medianAndQuartiles(r.translation_percent),
                        medianAndQuartiles(r.rotation_deg), medianAndQuartiles(r.yaw_deg));
  }
  return text;
}

std::string endPointLines(const Evaluation& e) {
  return fmt::format(
      "end point\n"
      "  after alignment   {:.4f} m, {:.3f} % of the path\n"
      "  from equal starts {:.4f} m, {:.3f} % of the path\n",
      e.end_point_m, e.percentOfPath(e.end_point_m), e.drift_m, e.percentOfPath(e.drift_m));
}

std::string claimsRow(const char* name, const ReportedAxes& axes) {
  return fmt::format("  {:<16}{:>10.1f}{:>8.1f}{:>8.1f}{:>16.2f}{:>8.2f}{:>8.2f}\n", name,
                     axes.within_3_sigma_percent.x(), axes.within_3_sigma_percent.y(),
                     axes.within_3_sigma_percent.z(), axes.rms_sigmas.x(), axes.rms_sigmas.y(),
                     axes.rms_sigmas.z());
}

std::string claimsTable(const ConsistencyCheck& claims) {
  if (claims.poses == 0) return "";
  std::string text = fmt::format(
      "errors against claimed sigmas from equal {}, {} poses\n",
      claims.basis == HeadingBasis::Start ? "starts" : "positions, heading from north", claims.poses);
  text += fmt::format("  {:<16}{:>10}{:>8}{:>8}{:>16}{:>8}{:>8}\n", "", "x (% < 3)", "y", "z",
                      "x (rms sigmas)", "y", "z");
  return text + claimsRow("position", claims.position) + claimsRow("rotation", claims.rotation);
}

}  // namespace

std::string evaluationTable(const Evaluation& e) {
  std::string text = overview(e);
  for (const std::string& part :
       {absoluteTable(e), consecutiveTable(e), relativeTable(e), endPointLines(e), claimsTable(e.claims)}) {
    if (!part.empty()) text += "\n" + part;
  }
  return text;
}

}  // namespace lodeline

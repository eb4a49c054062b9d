#include "lodeline/evaluation/figures/several_estimates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "lodeline/evaluation/figures/plot_figures.h"

namespace lodeline {
namespace {

using gnuplot::Curve;

/// Colours that people with colour blindness tell apart (Okabe and Ito, 2008).
constexpr std::array kColours = {"#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

const char* colourOf(size_t estimate) { return kColours[estimate % kColours.size()]; }

/// Text between single quotes of gnuplot.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "''" : std::string(1, c);
  return result + "'";
}

/// Whether the pairs before and at `i` are so far apart that no line joins them.
bool isBreak(const Evaluation& e, size_t i) {
  const double interval_s = medianInterval(e.estimate).seconds();
  return i > 0 && (e.pairs.time[i] - e.pairs.time[i - 1]).seconds() > std::max(1.0, 3.0 * interval_s);
}

/// Data block and the plot clause of a curve per estimate.
template <typename PointOf>
std::string curves(const std::vector<NamedEvaluation>& estimates, const PointOf& pointOf,
                   std::string* clauses) {
  std::string blocks;
  for (size_t k = 0; k < estimates.size(); ++k) {
    const Evaluation& e = estimates[k].evaluation;
    Curve curve;
    for (size_t i = 0; i < e.pairs.size(); ++i) {
      const auto [x, y] = pointOf(e, i);
      curve.points.push_back({x, y, isBreak(e, i)});
    }
    blocks += gnuplot::dataBlock(fmt::format("estimate{}", k), curve);
    *clauses += fmt::format("{}$estimate{} with lines lc '{}' lw 1.8 title {} noenhanced",
                            clauses->empty() ? "" : ", ", k, colourOf(k), quoted(estimates[k].name));
  }
  return blocks;
}

}  // namespace

std::string severalTable(const std::vector<NamedEvaluation>& estimates) {
  size_t width = 8;
  for (const NamedEvaluation& named : estimates) width = std::max(width, named.name.size());
  std::string text =
      fmt::format("{:<{}}{:>16}{:>15}{:>16}{:>11}{:>13}{:>15}\n", "estimate", width, "completion (%)",
                  "position (m)", "rotation (deg)", "yaw (deg)", "scale (%)", "end point (m)");
  for (const auto& [name, e] : estimates) {
    text += fmt::format("{:<{}}{:>16.2f}{:>15.4f}{:>16.3f}{:>11.3f}{:>13.3f}{:>15.4f}\n", name, width,
                        100.0 * e.completion.share, e.absolute.position().rmse, e.absolute.rotation().rmse,
                        e.absolute.yaw().rmse, 100.0 * e.alignment.scaleError(), e.end_point_m);
  }
  return text + "errors are root mean squares after the alignment; the end point is that of the last pair\n";
}

gnuplot::Figure severalErrorsFigure(const std::vector<NamedEvaluation>& estimates) {
  gnuplot::Figure figure;
  figure.name = "position_errors";
  figure.height_px = 600;
  std::string clauses;
  const Time origin = estimates.front().evaluation.pairs.time.front();
  figure.commands += curves(
      estimates,
      [&](const Evaluation& e, size_t i) {
        return std::pair((e.pairs.time[i] - origin).seconds(), e.absolute.position_m[i].norm());
      },
      &clauses);
  figure.commands +=
      "set title 'Position error after alignment'\nset xlabel 'time (s)'\nset ylabel 'error (m)'\nset grid "
      "lc "
      "'#dddddd'\nset yrange [0:*]\nset key tmargin center horizontal\nplot " +
      clauses + "\n";
  return figure;
}

gnuplot::Figure severalPathsFigure(const std::vector<NamedEvaluation>& estimates) {
  gnuplot::Figure figure;
  figure.name = "paths_from_above";
  std::string clauses;
  figure.commands += curves(
      estimates,
      [](const Evaluation& e, size_t i) {
        const Vec3& position = e.aligned_estimate[i].translation;
        return std::pair(position.x(), position.y());
      },
      &clauses);
  Curve reference;
  for (const StampedPose& pose : estimates.front().evaluation.reference.poses)
    reference.points.push_back({pose.world_from_body.translation.x(), pose.world_from_body.translation.y()});
  figure.commands += gnuplot::dataBlock("reference", reference);
  figure.commands +=
      "set title 'Paths from above'\nset xlabel 'x (m)'\nset ylabel 'y (m)'\nset size ratio -1\nset grid lc "
      "'#dddddd'\nset key tmargin center horizontal\nplot $reference with lines lc '#000000' lw 1.2 title "
      "'reference', " +
      clauses + "\n";
  return figure;
}

}  // namespace lodeline

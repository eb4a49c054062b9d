#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/evaluation/figures/plot_figures.h"

namespace lodeline {
namespace {

using gnuplot::Curve;

const char* const kStyle =
    "set grid lc '#dddddd' lt 1 lw 0.7\nset border lw 0.8\nset tics nomirror out\n"
    "set key tmargin right samplen 2 horizontal\n";

template <typename ValueOf>
Curve curveOverTime(const Evaluation& e, ValueOf valueOf) {
  const Duration interval = medianInterval(e.estimate);
  const Duration gap = std::max(Duration::fromSeconds(1.0), interval + interval + interval);
  Curve curve;
  for (std::size_t i = 0; i < e.pairs.size(); ++i) {
    const bool broken = i > 0 && e.pairs.time[i] - e.pairs.time[i - 1] > gap;
    curve.points.push_back({(e.pairs.time[i] - e.pairs.time.front()).seconds(), valueOf(i), broken});
  }
  return curve;
}

/// Rows for gnuplot's candlesticks: length, 5 %, quartiles, median, 95 %.
std::vector<std::vector<double>> boxRows(const Evaluation& e, std::vector<double> RelativeErrors::*values) {
  std::vector<std::vector<double>> rows;
  for (const RelativeErrors& r : e.relative) {
    std::vector<double> sorted = r.*values;
    std::sort(sorted.begin(), sorted.end());
    rows.push_back({r.length_m, quantile(sorted, 0.05), quantile(sorted, 0.25), quantile(sorted, 0.5),
                    quantile(sorted, 0.75), quantile(sorted, 0.95)});
  }
  return rows;
}

/// A third of the smallest distance between two lengths, so that boxes do not touch.
double boxWidth(const Evaluation& e) {
  double width_m = 0.4 * e.relative.front().length_m;
  for (std::size_t i = 1; i < e.relative.size(); ++i) {
    width_m = std::min(width_m, 0.4 * std::abs(e.relative[i].length_m - e.relative[i - 1].length_m));
  }
  return width_m;
}

std::string boxPlot(const std::string& block, const char* colour) {
  return fmt::format(
      "plot ${0} using 1:3:2:6:5 with candlesticks whiskerbars 0.5 lc '{1}' fs solid 0.25 border lc '{1}' "
      "notitle, "
      "${0} using 1:4:4:4:4 with candlesticks lc '#000000' lw 2 notitle, "
      "${0} using 1:4 with lines dt 3 lc '#000000' notitle\n",
      block, colour);
}

}  // namespace

gnuplot::Figure errorOverTimeFigure(const Evaluation& e) {
  const auto& position = e.absolute.position_m;
  gnuplot::Figure figure;
  figure.name = "error_over_time";
  std::string& c = figure.commands;
  c += gnuplot::dataBlock("norm", curveOverTime(e, [&](std::size_t i) { return position[i].norm(); }));
  c += gnuplot::dataBlock("ex", curveOverTime(e, [&](std::size_t i) { return position[i].x(); }));
  c += gnuplot::dataBlock("ey", curveOverTime(e, [&](std::size_t i) { return position[i].y(); }));
  c += gnuplot::dataBlock("ez", curveOverTime(e, [&](std::size_t i) { return position[i].z(); }));
  c += gnuplot::dataBlock("angle",
                          curveOverTime(e, [&](std::size_t i) { return e.absolute.rotation_deg[i]; }));
  c += gnuplot::dataBlock("yaw", curveOverTime(e, [&](std::size_t i) { return e.absolute.yaw_deg[i]; }));
  c += fmt::format(
      "{}set multiplot layout 2,1\nset label 1 'Errors after {} alignment' at graph 0, 1.07 left\n", kStyle,
      alignmentTitle(e.options.alignment));
  c += "set tmargin 2.5\nset lmargin 10\nset rmargin 3\nset offsets 0, 0, graph 0.05, graph 0.02\n";
  c += "set ylabel 'position error (m)'\n";
  c += "plot $norm with lines lc '#000000' lw 1.6 title 'norm', $ex with lines lc '#d55e00' title 'x', "
       "$ey with lines lc '#009e73' title 'y', $ez with lines lc '#0072b2' title 'z'\n";
  const bool by_index = e.reference.time_base == TimeBase::Index;
  c += fmt::format("unset label 1\nset ylabel 'angle (deg)'\nset xlabel '{}'\n",
                   by_index ? "row" : "time (s)");
  c += "plot $angle with lines lc '#000000' lw 1.6 title 'rotation', $yaw with lines lc '#0072b2' title "
       "'yaw'\n";
  c += "unset multiplot\n";
  return figure;
}

gnuplot::Figure relativeErrorFigure(const Evaluation& e) {
  gnuplot::Figure figure;
  figure.name = "relative_error_over_distance";
  std::string& c = figure.commands;
  c += gnuplot::dataBlock("position", boxRows(e, &RelativeErrors::translation_percent));
  c += gnuplot::dataBlock("yaw", boxRows(e, &RelativeErrors::yaw_deg));
  c += kStyle;
  c += "set multiplot layout 2,1 title 'Relative errors over stretches of the path: median, quartiles, "
       "5 and 95 %'\n";
  double largest_m = 0.0;
  std::string tics;
  for (const RelativeErrors& r : e.relative) {
    largest_m = std::max(largest_m, r.length_m);
    tics += fmt::format("{}{:.3g}", tics.empty() ? "" : ", ", r.length_m);
  }
  c +=
      fmt::format("set boxwidth {}\nset xrange [0:{}]\nset xtics ({})\n", boxWidth(e), 1.1 * largest_m, tics);
  c += "set tmargin 2.5\nset lmargin 10\nset rmargin 3\nset yrange [0:*]\nset offsets 0, 0, graph 0.05, 0\n";
  c += "set ylabel 'position error (%)'\n" + boxPlot("position", "#d55e00");
  c += "set ylabel 'yaw error (deg)'\nset xlabel 'length of the stretch (m)'\n" + boxPlot("yaw", "#0072b2");
  c += "unset multiplot\n";
  return figure;
}

}  // namespace lodeline

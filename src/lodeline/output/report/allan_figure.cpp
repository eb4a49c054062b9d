#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/report/noise_report.h"

namespace lodeline {
namespace {

/// Columns: tau; deviation of x, y, z; fit of all axes; its white noise, instability and walk. The column of
/// an unresolved noise is empty.
std::vector<std::vector<double>> rows(const SensorNoise& noise) {
  const NoiseFit& fit = noise.all;
  const auto line = [](const NoiseFigure& figure, double unit_variance) {
    return figure.resolved ? figure.value * std::sqrt(unit_variance) : std::nan("");
  };
  std::vector<std::vector<double>> rows;
  for (const AllanPoint& point : noise.curve.points) {
    const Vec3 deviation = point.deviation();
    const auto unit = unitAllanVariance(point.tau_s);
    const bool fitted = point.tau_s >= 0.99 * fit.shortest_s && point.tau_s <= 1.01 * fit.longest_s;
    rows.push_back({point.tau_s, deviation.x(), deviation.y(), deviation.z(),
                    fitted ? std::sqrt(fit.variance(point.tau_s)) : std::nan(""), line(fit.white, unit[1]),
                    line(fit.instability, unit[2]), line(fit.walk, unit[3])});
  }
  return rows;
}

}  // namespace

gnuplot::Figure allanFigure(const SensorNoise& noise) {
  const auto data = rows(noise);
  double least = INFINITY, most = 0.0;
  for (const auto& row : data) {
    for (size_t column = 1; column <= 3; ++column) {
      if (row[column] > 0.0) least = std::min(least, row[column]);
      most = std::max(most, row[column]);
    }
  }
  gnuplot::Figure figure;
  figure.name = "allan_" + noise.sensor.name;
  figure.commands = gnuplot::dataBlock("allan", data);
  figure.commands += fmt::format(
      "set logscale xy\nset grid xtics ytics mxtics mytics lc '#dddddd' lt 1 lw 0.7, lc '#eeeeee' lt 1 lw "
      "0.5\n"
      "set border lw 0.8\nset tics nomirror out\nset format xy '10^{{%T}}'\nset datafile missing 'nan'\n"
      "set xlabel 'averaging time (s)'\nset ylabel 'Allan deviation ({0})'\nset yrange [{1:.6g}:{2:.6g}]\n"
      "set key tmargin right samplen 2 horizontal\n"
      "set tmargin 3\nset label 1 '{3}, {4:.2f} h' at graph 0, 1.04 left\n",
      noise.sensor.unit, 0.5 * least, 2.0 * most, noise.sensor.name, noise.duration_s / 3600.0);
  figure.commands +=
      "plot $allan using 1:6 with lines dt 2 lc '#888888' title 'N', $allan using 1:7 with lines dt 3 lc "
      "'#888888' "
      "title 'B', $allan using 1:8 with lines dt 4 lc '#888888' title 'K', $allan using 1:2 with points pt 7 "
      "ps 0.6 lc "
      "'#d55e00' title 'x', $allan using 1:3 with points pt 7 ps 0.6 lc '#009e73' title 'y', $allan using "
      "1:4 with "
      "points pt 7 ps 0.6 lc '#0072b2' title 'z', $allan using 1:5 with lines lw 1.6 lc '#000000' title "
      "'fit'\n";
  return figure;
}

}  // namespace lodeline

#include "lodeline/magnetometer/calibration/calibration_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr size_t kMostPoints = 3000;

struct Cloud {
  std::vector<Vec3> used, rejected;
};

template <typename Transform>
Cloud cloudOf(const MagnetometerCalibrationResult& result, const Transform& transform) {
  Cloud cloud;
  const size_t stride = result.readings.size() / kMostPoints + 1;
  for (size_t i = 0; i < result.readings.size(); i += stride) {
    (result.iron.used[i] ? cloud.used : cloud.rejected).push_back(transform(result.readings[i]));
  }
  return cloud;
}

std::string block(const std::string& name, const std::vector<Vec3>& points) {
  std::vector<std::vector<double>> rows;
  for (const Vec3& p : points) rows.push_back({p.x(), p.y(), p.z()});
  // gnuplot does not accept a data block without rows.
  if (rows.empty()) rows.push_back({NAN, NAN, NAN});
  return gnuplot::dataBlock(name, rows);
}

/// Half the side of a square about `middle` that contains all points, with a margin.
double reach(const Cloud& cloud, const Vec3& middle) {
  double reach = 0.0;
  for (const auto* points : {&cloud.used, &cloud.rejected}) {
    for (const Vec3& p : *points) reach = std::max(reach, (p - middle).cwiseAbs().maxCoeff());
  }
  return 1.08 * reach;
}

/// The largest of 1, 2, 5, 10, 20, … that does not exceed `size`.
double niceStep(double size) {
  const double power = std::pow(10.0, std::floor(std::log10(size)));
  const double factor = size / power;
  return power * (factor >= 5.0 ? 5.0 : factor >= 2.0 ? 2.0 : 1.0);
}

std::string panels(const std::string& data, const std::string& what, const std::string& unit,
                   const Vec3& middle, double half_side, double radius) {
  std::string text;
  const int planes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (const auto& plane : planes) {
    const int i = plane[0], j = plane[1];
    text += fmt::format("set title '{}, {}{}' noenhanced\nset xlabel '{} ({})'\nset ylabel '{} ({})'\n", what,
                        "xyz"[i], "xyz"[j], "xyz"[i], unit, "xyz"[j], unit);
    text += fmt::format("set xtics {0}\nset ytics {0}\n", niceStep(half_side / 2.0));
    text += fmt::format("set xrange [{}:{}]\nset yrange [{}:{}]\n", middle[i] - half_side,
                        middle[i] + half_side, middle[j] - half_side, middle[j] + half_side);
    text += fmt::format(
        "plot ${0}_used using {1}:{2} with points pt 7 ps 0.35 lc '#0072b2' notitle, "
        "${0}_rejected using {1}:{2} with points pt 2 ps 0.8 lc '#d55e00' notitle",
        data, i + 1, j + 1);
    if (radius > 0.0)
      text += fmt::format(", {0}*cos(t),{0}*sin(t) with lines lc '#000000' lw 1.2 notitle", radius);
    text += "\n";
  }
  return text;
}

}  // namespace

gnuplot::Figure cloudFigure(const MagnetometerCalibrationResult& result) {
  const MagnetometerFit& fit = result.fit;
  const double factor = fit.raw_readings ? 1.0 : 1e6;
  const Cloud raw = cloudOf(result, [&](const Vec3& reading) -> Vec3 { return factor * reading; });
  const Cloud corrected =
      cloudOf(result, [&](const Vec3& reading) -> Vec3 { return 1e6 * fit.corrected_M(reading); });
  const double radius_uT = 1e6 * fit.field_strength_T;
  const Vec3 centre = factor * fit.hard_iron;
  gnuplot::Figure figure;
  figure.name = "cloud";
  figure.width_px = 1500;
  figure.height_px = 1060;
  figure.commands = block("raw_used", raw.used) + block("raw_rejected", raw.rejected) +
                    block("corrected_used", corrected.used) + block("corrected_rejected", corrected.rejected);
  figure.commands +=
      "set multiplot layout 2,3\nset parametric\nset trange [0:2*pi]\nset samples 200\nset size ratio -1\n"
      "set grid lc '#dddddd' lt 1 lw 0.7\nset border lw 0.8\nset tics nomirror out font ',12'\n";
  figure.commands +=
      panels("raw", "as read", fit.raw_readings ? "counts" : "uT", centre, reach(raw, centre), 0.0);
  figure.commands +=
      panels("corrected", "corrected", "uT", Vec3::Zero(),
             std::min(2.0 * radius_uT, std::max(1.1 * radius_uT, reach(corrected, Vec3::Zero()))), radius_uT);
  figure.commands += "unset multiplot\n";
  return figure;
}

gnuplot::Figure coverageFigure(const MagnetometerCalibrationResult& result) {
  std::vector<std::vector<double>> cells;
  for (int zone = 0; zone < SphereCoverage::kZones; ++zone) {
    for (int sector = 0; sector < SphereCoverage::kSectors; ++sector) {
      const double azimuth_deg = (sector + 0.5) * 360.0 / SphereCoverage::kSectors - 180.0;
      const double z = (zone + 0.5) * 2.0 / SphereCoverage::kZones - 1.0;
      const int count = result.coverage.count(zone, sector);
      cells.push_back({azimuth_deg, z, count > 0 ? std::log10(static_cast<double>(count)) : NAN});
    }
  }
  gnuplot::Figure figure;
  figure.name = "coverage";
  figure.width_px = 1100;
  figure.height_px = 640;
  figure.commands = gnuplot::dataBlock("cells", cells);
  figure.commands += fmt::format(
      "set title 'Directions of the field in sensor axes: {:.0f} % of the sphere seen (grey: not seen)' "
      "noenhanced\n"
      "set xlabel 'azimuth from x towards y (degrees)'\nset ylabel 'z component / field'\nset cblabel "
      "'readings'\n"
      "set xrange [-180:180]\nset yrange [-1:1]\nset xtics 30\nset ytics 0.3333333\nset format y '%.2f'\n"
      "set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb '#d0d0d0' fillstyle solid "
      "noborder\n"
      "set palette defined (0 '#c6dbef', 1 '#4292c6', 2 '#08306b')\nset cbrange [0:]\n"
      "set cbtics ('1' 0, '10' 1, '100' 2, '1000' 3, '10000' 4)\nset tics out nomirror\n"
      "plot $cells using 1:2:3 with image notitle\n",
      100.0 * result.coverage.share());
  return figure;
}

}  // namespace lodeline

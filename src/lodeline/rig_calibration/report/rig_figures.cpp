#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/rig_calibration/report/rig_report.h"

namespace lodeline {
namespace {

constexpr size_t kMostPoints = 3000;

using Rows = std::vector<std::vector<double>>;

std::string imageAxes(const CameraCalibration& c) {
  return fmt::format(
      "set xrange [0:{}]\nset yrange [{}:0]\nset size ratio -1\nset xlabel 'x (px)'\nset ylabel 'y (px)'\n"
      "set tics out nomirror\nset rmargin at screen 0.80\nset format cb '%.3g'\nset grid lc '#dddddd' lt 1 "
      "lw 0.7\n",
      c.width_px, c.height_px);
}

gnuplot::Figure figureOf(const CameraCalibrationResult& camera, const char* name) {
  gnuplot::Figure figure;
  figure.name = fmt::format("{}_{}", camera.calibration.name, name);
  figure.width_px = 1000;
  figure.height_px = 800;
  return figure;
}

double limitOf(const CameraCalibrationResult& camera) { return 4.0 * std::max(camera.sigma_px, 0.02); }

/// Every corner in the image, coloured by its error.
gnuplot::Figure coverageFigure(const CameraCalibrationResult& camera) {
  Rows rows;
  const size_t stride = camera.corners.size() / kMostPoints + 1;
  for (size_t i = 0; i < camera.corners.size(); i += stride) {
    const CornerError& corner = camera.corners[i];
    rows.push_back({corner.pixel.x(), corner.pixel.y(), corner.error_px.norm()});
  }
  gnuplot::Figure figure = figureOf(camera, "coverage");
  figure.commands = gnuplot::dataBlock("corners", rows) + imageAxes(camera.calibration);
  figure.commands += fmt::format(
      "set title '{}: corners of the board, {} views, {:.0f} % of the image' noenhanced\nset cblabel 'error "
      "(px)'\nset cbrange [0:{}]\nset palette defined (0 '#2c7bb6', 0.5 '#ffd966', 1 '#d7191c')\n"
      "plot $corners using 1:2:3 with points pt 7 ps 0.4 lc palette notitle\n",
      camera.calibration.name, camera.views, 100.0 * camera.coverage_share, limitOf(camera));
  return figure;
}

/// The errors of the corners about zero, with the circle of two sigmas.
gnuplot::Figure residualFigure(const CameraCalibrationResult& camera) {
  Rows rows;
  const size_t stride = camera.corners.size() / kMostPoints + 1;
  for (size_t i = 0; i < camera.corners.size(); i += stride)
    rows.push_back({camera.corners[i].error_px.x(), camera.corners[i].error_px.y()});
  gnuplot::Figure figure = figureOf(camera, "residuals");
  figure.width_px = 800;
  const double limit_px = 1.5 * limitOf(camera);
  figure.commands = gnuplot::dataBlock("errors", rows);
  figure.commands += fmt::format(
      "set title '{0}: errors of the corners, {1:.3f} px rms (circle: two sigmas)' noenhanced\n"
      "set xlabel 'error in x (px)'\nset ylabel 'error in y (px)'\nset xrange [-{2}:{2}]\nset yrange "
      "[-{2}:{2}]\nset size ratio -1\nset parametric\nset trange [0:2*pi]\nset samples 200\n"
      "set grid lc '#dddddd' lt 1 lw 0.7\nset tics out nomirror\n"
      "plot $errors using 1:2 with points pt 7 ps 0.25 lc '#0072b2' notitle, {3}*cos(t),{3}*sin(t) with "
      "lines "
      "lc '#000000' lw 1.2 notitle\n",
      camera.calibration.name, camera.rms_px, limit_px, 2.0 * camera.sigma_px);
  return figure;
}

/// Mean errors in the cells of a grid: what the model of the lens cannot represent.
gnuplot::Figure biasFigure(const CameraCalibrationResult& camera) {
  constexpr int kColumns = 16, kRows = 12, kLeast = 8;
  struct Cell {
    Vec2 sum = Vec2::Zero();
    int count = 0;
  };
  std::vector<Cell> cells(kColumns * kRows);
  const CameraCalibration& c = camera.calibration;
  for (const CornerError& corner : camera.corners) {
    if (corner.error_px.norm() > 5.0 * camera.sigma_px) continue;
    const int x = std::clamp(static_cast<int>(corner.pixel.x() * kColumns / c.width_px), 0, kColumns - 1);
    const int y = std::clamp(static_cast<int>(corner.pixel.y() * kRows / c.height_px), 0, kRows - 1);
    Cell& cell = cells[static_cast<size_t>(y * kColumns + x)];
    cell.sum += corner.error_px;
    ++cell.count;
  }
  // The arrow of one corner sigma is one cell long.
  const double scale = c.width_px / static_cast<double>(kColumns) / std::max(camera.sigma_px, 0.02);
  Rows rows;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) {
      const Cell& cell = cells[static_cast<size_t>(y * kColumns + x)];
      if (cell.count < kLeast) continue;
      const Vec2 mean_px = cell.sum / cell.count;
      rows.push_back({(x + 0.5) * c.width_px / kColumns, (y + 0.5) * c.height_px / kRows, scale * mean_px.x(),
                      scale * mean_px.y(), mean_px.norm()});
    }
  }
  if (rows.empty()) rows.push_back({NAN, NAN, NAN, NAN, NAN});
  gnuplot::Figure figure = figureOf(camera, "mean_residuals");
  figure.commands = gnuplot::dataBlock("cells", rows) + imageAxes(c);
  figure.commands += fmt::format(
      "set title '{}: mean errors over the image, enlarged {:.0f} times' noenhanced\nset cblabel 'mean error "
      "(px)'\nset cbrange [0:{}]\nset palette defined (0 '#2c7bb6', 0.5 '#ffd966', 1 '#d7191c')\n"
      "plot $cells using 1:2:3:4:5 with vectors head filled lw 1.6 lc palette notitle\n",
      c.name, scale, std::max(camera.sigma_px, 0.02));
  return figure;
}

}  // namespace

std::vector<gnuplot::Figure> rigCalibrationFigures(const RigCalibrationResult& result) {
  std::vector<gnuplot::Figure> figures;
  for (const CameraCalibrationResult& camera : result.cameras) {
    figures.push_back(coverageFigure(camera));
    figures.push_back(residualFigure(camera));
    figures.push_back(biasFigure(camera));
  }
  return figures;
}

}  // namespace lodeline

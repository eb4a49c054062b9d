#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/survey/formats/gis/xml_text.h"
#include "lodeline/output/walls/section/wall_sections.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

constexpr double kPanel_px = 260.0, kTitle_px = 40.0, kCaption_px = 24.0, kMargin_px = 6.0;
constexpr size_t kColumns = 4;

/// Half width of the panels, m: nine in ten of all directions with walls end within it. A single view along a
/// passage would else make all sections small.
double reachOf(const std::vector<StationWalls>& walls) {
  std::vector<double> radii_m;
  for (const StationWalls& wall : walls) {
    for (const auto& radius : wall.outline.radii_m) {
      if (radius) radii_m.push_back(*radius);
    }
  }
  std::sort(radii_m.begin(), radii_m.end());
  return radii_m.empty() ? 1.0 : std::max(1.0, 1.15 * quantile(radii_m, 0.9));
}

/// Round length of at least 30 px, m.
double barLength_m(double px_per_m) {
  double length_m = 0.1;
  for (size_t step = 0; length_m * px_per_m < 30.0; ++step) length_m *= step % 3 == 1 ? 2.5 : 2.0;
  return length_m;
}

std::string captionOf(size_t station, const StationWalls& wall) {
  const SectionOutline& outline = wall.outline;
  if (outline.coverage == 0.0) return fmt::format("{}: no walls seen", station);
  const std::string area = outline.area_m2 ? fmt::format("{:.1f} m²", *outline.area_m2)
                                           : fmt::format("open, {:.1f} m² seen", outline.seen_area_m2);
  return fmt::format("{}: {}, walls in {:.0f} %", station, area, 100.0 * outline.coverage);
}

/// One section about the middle of its panel.
std::string panel(size_t station, const StationWalls& wall, double px_per_m, const Vec2& corner) {
  const Vec2 middle = corner + Vec2(0.5 * kPanel_px, kCaption_px + 0.5 * kPanel_px - kMargin_px);
  std::string text = fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", corner.x() + kMargin_px,
                                 corner.y() + 16.0, captionOf(station, wall));
  text +=
      fmt::format("<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n",
                  corner.x() + kMargin_px, corner.y() + kCaption_px, kPanel_px - 2.0 * kMargin_px,
                  kPanel_px - 2.0 * kMargin_px);
  text += fmt::format(
      "<path class=\"station\" d=\"M{0:.1f} {1:.1f}h12M{2:.1f} {3:.1f}v12\"/>\n<path class=\"wall\" d=\"",
      middle.x() - 6.0, middle.y(), middle.x(), middle.y() - 6.0);
  for (const SectionLine& line : wall.lines) {
    const Vec2 from = middle + px_per_m * Vec2(line.from.x(), -line.from.y());
    const Vec2 to = middle + px_per_m * Vec2(line.to.x(), -line.to.y());
    const Vec2 half = Vec2::Constant(0.5 * kPanel_px - kMargin_px);
    if (((from - middle).cwiseAbs() - half).maxCoeff() > 0.0) continue;
    text += fmt::format("M{:.2f} {:.2f}L{:.2f} {:.2f}", from.x(), from.y(), to.x(), to.y());
  }
  return text + "\"/>\n";
}

}  // namespace

std::string sectionsSvg(const DiveMap& map, const std::vector<StationWalls>& walls) {
  const size_t rows = (walls.size() + kColumns - 1) / kColumns;
  const double width_px = kColumns * kPanel_px;
  const double height_px = kTitle_px + static_cast<double>(rows) * (kPanel_px + kCaption_px) + 10.0;
  const double px_per_m = (0.5 * kPanel_px - kMargin_px) / reachOf(walls);
  const double bar_m = barLength_m(px_per_m);
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "viewBox=\"0 0 {0:.0f} {1:.0f}\">\n<style>text{{font:13px sans-serif;fill:#222}}"
      ".wall{{stroke:#1b4965;stroke-width:1.4;fill:none;stroke-linecap:round}}"
      ".frame{{stroke:#d8dcdf;fill:none}}.station{{stroke:#c1121f;stroke-width:1.2;fill:none}}"
      ".bar{{stroke:#222;stroke-width:2;fill:none}}</style>\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      width_px, height_px);
  text += fmt::format(
      "<text x=\"6\" y=\"24\">{}: sections across the passage, looking along the dive; gaps were not "
      "seen</text>\n",
      xmlEscaped(map.title));
  text += fmt::format(
      "<path class=\"bar\" d=\"M{0:.1f} 14v8h{1:.1f}v-8\"/><text x=\"{2:.1f}\" y=\"24\">{3:g} m</text>\n",
      width_px - 60.0 - bar_m * px_per_m, bar_m * px_per_m, width_px - 50.0, bar_m);
  for (size_t i = 0; i < walls.size(); ++i) {
    const size_t row = i / kColumns, column = i % kColumns;
    const Vec2 corner(static_cast<double>(column) * kPanel_px,
                      kTitle_px + static_cast<double>(row) * (kPanel_px + kCaption_px));
    text += panel(i, walls[i], px_per_m, corner);
  }
  return text + "</svg>\n";
}

}  // namespace lodeline

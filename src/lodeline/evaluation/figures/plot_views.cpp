#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/evaluation/figures/plot_figures.h"

namespace lodeline {
namespace {

using gnuplot::Curve;

/// Time span in which the reference is drawn: that of the images, or all of it when no images were given.
struct Span {
  Time begin;
  Time end;
};

Span expectedSpan(const Evaluation& e) {
  const auto& stamps = e.options.expected_stamps;
  if (stamps.empty()) return {e.reference.poses.front().time, e.reference.poses.back().time};
  const auto [first, last] = std::minmax_element(stamps.begin(), stamps.end());
  const Duration tolerance = Duration::fromSeconds(e.options.association.tolerance_s);
  return {std::min(*first, e.pairs.time.front()) - tolerance,
          std::max(*last, e.pairs.time.back()) + tolerance};
}

Duration longestGap(const Evaluation& e) {
  const Duration interval = medianInterval(e.estimate);
  return std::max(Duration::fromSeconds(1.0), interval + interval + interval);
}

struct Curves {
  Curve missed;     ///< reference without estimate
  Curve reference;  ///< reference while there is an estimate
  Curve estimate;
};

Curves curvesAlong(const Evaluation& e, const Vec3& right, const Vec3& up) {
  Curves curves;
  const Span span = expectedSpan(e);
  const Duration gap = longestGap(e);
  for (std::size_t i = 0; i < e.pairs.size(); ++i) {
    const Vec3& p = e.aligned_estimate[i].translation;
    const bool broken = i > 0 && e.pairs.time[i] - e.pairs.time[i - 1] > gap;
    curves.estimate.points.push_back({p.dot(right), p.dot(up), broken, e.absolute.position_m[i].norm()});
  }
  std::size_t next_pair = 0;
  bool was_covered = false;
  for (const StampedPose& pose : e.reference.poses) {
    if (pose.time < span.begin || pose.time > span.end) continue;
    while (next_pair < e.pairs.size() && e.pairs.time[next_pair] < pose.time) ++next_pair;
    const bool after_last = next_pair == e.pairs.size();
    const bool before_first = next_pair == 0 && e.pairs.time.front() > pose.time;
    const bool covered = !after_last && !before_first &&
                         (next_pair == 0 || e.pairs.time[next_pair] - e.pairs.time[next_pair - 1] <= gap);
    const Vec3& p = pose.world_from_body.translation;
    const Curve::Point point{p.dot(right), p.dot(up), covered != was_covered};
    (covered ? curves.reference : curves.missed).points.push_back(point);
    was_covered = covered;
  }
  return curves;
}

struct Range {
  double min = INFINITY;
  double max = -INFINITY;

  void include(double value) {
    min = std::min(min, value);
    max = std::max(max, value);
  }
  double extent() const { return max - min; }
  void widenTo(double extent_wanted) {
    const double margin = std::max(0.0, extent_wanted - extent()) / 2.0;
    min -= margin;
    max += margin;
  }
};

/// Ranges with a margin; the smaller one is enlarged to limit the aspect ratio.
std::pair<Range, Range> boxAround(const Curves& curves) {
  Range x;
  Range y;
  for (const Curve* curve : {&curves.missed, &curves.reference, &curves.estimate}) {
    for (const Curve::Point& point : curve->points) {
      x.include(point.x);
      y.include(point.y);
    }
  }
  const double largest = std::max({x.extent(), y.extent(), 1e-3});
  x.widenTo(std::max(x.extent() + 0.1 * largest, 0.5 * largest));
  y.widenTo(std::max(y.extent() + 0.1 * largest, 0.3 * largest));
  return {x, y};
}

std::string plotCommand(const Curves& curves) {
  const Curve::Point& start = curves.estimate.points.front();
  const Curve::Point& end = curves.estimate.points.back();
  const char* missed =
      curves.missed.points.empty() ? "" : "$missed with lines lc '#b0b0b0' lw 1.5 title 'not covered', ";
  return fmt::format(
      "plot {}$reference with lines lc '#000000' lw 1.8 title 'reference', "
      "$estimate with lines lc palette lw 2.4 title 'estimate, coloured by error', "
      "'-' with points pt 6 ps 2 lw 2 lc '#d55e00' title 'start', "
      "'-' with points pt 4 ps 2 lw 2 lc '#d55e00' title 'end'\n{} {}\ne\n{} {}\ne\n",
      missed, start.x, start.y, end.x, end.y);
}

gnuplot::Figure viewFigure(const Evaluation& e, const char* name, const char* title, const char* axis_names,
                           const Vec3& right, const Vec3& up) {
  const Curves curves = curvesAlong(e, right, up);
  const auto [x, y] = boxAround(curves);
  constexpr int kBoxWidth = 1060;
  constexpr int kMargins = 210;
  gnuplot::Figure figure;
  figure.name = name;
  figure.height_px = kMargins + static_cast<int>(kBoxWidth * std::min(1.3, y.extent() / x.extent()));
  figure.commands = gnuplot::dataBlock("missed", curves.missed) +
                    gnuplot::dataBlock("reference", curves.reference) +
                    gnuplot::dataBlock("estimate", curves.estimate);
  figure.commands += fmt::format(
      "set title '{}: position error {:.3g} m rmse over {:.4g} m ({} alignment)' noenhanced\n"
      "set xlabel '{} (m)'\nset ylabel '{} (m)'\n"
      "set size ratio -1\nset tmargin 2.5\nset bmargin 5\nset xrange [{}:{}]\nset yrange [{}:{}]\n"
      "set grid lc '#dddddd' lt 1 lw 0.7\nset border lw 0.8\nset tics nomirror out\n"
      "set key bmargin center horizontal samplen 2\n"
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n"
      "set cbrange [0:*]\nset cblabel 'position error (m)'\n",
      title, e.absolute.position().rmse, e.reference_path_m, alignmentTitle(e.options.alignment),
      axis_names[0], axis_names[1], x.min, x.max, y.min, y.max);
  figure.commands += plotCommand(curves);
  return figure;
}

}  // namespace

gnuplot::Figure topViewFigure(const Evaluation& e) {
  return viewFigure(e, "top_view", "Top view", "xy", Vec3::UnitX(), Vec3::UnitY());
}

gnuplot::Figure sideViewFigure(const Evaluation& e) {
  Range x;
  Range y;
  for (const Rigid3& pose : e.pairs.reference) {
    x.include(pose.translation.x());
    y.include(pose.translation.y());
  }
  const bool along_x = x.extent() >= y.extent();
  return viewFigure(e, "side_view", "Side view", along_x ? "xz" : "yz",
                    along_x ? Vec3::UnitX() : Vec3::UnitY(), Vec3::UnitZ());
}

}  // namespace lodeline

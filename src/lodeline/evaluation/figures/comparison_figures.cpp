#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "lodeline/evaluation/figures/comparison_report.h"

namespace lodeline {
namespace {

using gnuplot::Curve;

/// Palette of Okabe and Ito, distinguishable for colour-blind readers.
constexpr std::array<const char*, 6> kColours = {"#0072b2", "#d55e00", "#009e73",
                                                 "#cc79a7", "#e69f00", "#56b4e9"};

const char* colourOf(std::size_t method) { return kColours[method % kColours.size()]; }

const ComparedRun* firstRun(const ComparedMethod& method) {
  for (const ComparedRun& run : method.runs) {
    if (run.errors) return &run;
  }
  return nullptr;
}

Curve curveOf(const std::vector<Vec3>& track_m) {
  Curve curve;
  for (const Vec3& p : track_m) curve.points.push_back({p.x(), p.y(), false});
  return curve;
}

struct Box {
  double least[2] = {INFINITY, INFINITY};
  double most[2] = {-INFINITY, -INFINITY};

  void include(const std::vector<Vec3>& track_m) {
    for (const Vec3& p : track_m) {
      for (int axis = 0; axis < 2; ++axis) {
        least[axis] = std::min(least[axis], p[axis]);
        most[axis] = std::max(most[axis], p[axis]);
      }
    }
  }
  double extent(int axis) const { return most[axis] - least[axis]; }
  /// Adds a margin of a twentieth, and limits the aspect ratio: the smaller side is at least 0.35 of the
  /// larger one.
  void widen() {
    const double largest = std::max({extent(0), extent(1), 1e-3});
    for (int axis = 0; axis < 2; ++axis) {
      const double margin = 0.5 * std::max(0.1 * largest, 0.35 * largest - extent(axis));
      least[axis] -= margin;
      most[axis] += margin;
    }
  }
};

std::string legend(const ComparedMethod& method, const RunErrors& errors) {
  return fmt::format("{}: ends {:.2f} % off", method.name, errors.end_point_percent);
}

/// Yaw errors of all runs of one method for every length that occurs in any run.
std::map<double, std::vector<double>> yawByLength(const ComparedMethod& method) {
  std::map<double, std::vector<double>> by_length;
  for (const ComparedRun& run : method.runs) {
    if (!run.errors) continue;
    for (const RelativeErrors& r : run.errors->relative) {
      std::vector<double>& all = by_length[r.length_m];
      all.insert(all.end(), r.yaw_deg.begin(), r.yaw_deg.end());
    }
  }
  return by_length;
}

/// Lengths of the path sections of all methods.
std::set<double> lengthsOf(const ComparedRecording& recording) {
  std::set<double> lengths_m;
  for (const ComparedMethod& method : recording.methods) {
    for (const auto& [length_m, errors] : yawByLength(method)) lengths_m.insert(length_m);
  }
  return lengths_m;
}

/// Smallest difference between two lengths, including zero as a length.
double smallestStep(const std::set<double>& lengths_m) {
  double step_m = INFINITY;
  double before_m = 0.0;
  for (const double length_m : lengths_m) {
    step_m = std::min(step_m, length_m - before_m);
    before_m = length_m;
  }
  return step_m;
}

}  // namespace

gnuplot::Figure trajectoriesFigure(const ComparedRecording& recording) {
  gnuplot::Figure figure;
  figure.name = recording.name + "_trajectories";
  Box box;
  std::string plot;
  for (std::size_t i = 0; i < recording.methods.size(); ++i) {
    const ComparedRun* run = firstRun(recording.methods[i]);
    if (run == nullptr) continue;
    if (plot.empty()) {
      figure.commands += gnuplot::dataBlock("reference", curveOf(run->errors->reference_track_m));
      plot = "plot $reference with lines lc '#000000' lw 2.2 title 'reference'";
      box.include(run->errors->reference_track_m);
    }
    box.include(run->errors->estimate_track_m);
    figure.commands += gnuplot::dataBlock(fmt::format("m{}", i), curveOf(run->errors->estimate_track_m));
    plot += fmt::format(", $m{} with lines lc '{}' lw 1.4 title '{}'", i, colourOf(i),
                        legend(recording.methods[i], *run->errors));
  }
  if (plot.empty()) return figure;
  box.widen();
  constexpr int kBoxWidth = 1060;
  constexpr int kMargins = 260;
  figure.height_px = kMargins + static_cast<int>(kBoxWidth * std::min(1.3, box.extent(1) / box.extent(0)));
  figure.commands += fmt::format(
      "set title '{}: from equal starts, seen from above' noenhanced\nset xlabel 'east (m)'\nset ylabel "
      "'north "
      "(m)'\n"
      "set size ratio -1\nset bmargin 8\nset xrange [{}:{}]\nset yrange [{}:{}]\nset grid lc '#dddddd' lt 1 "
      "lw 0.7\n"
      "set border lw 0.8\nset tics nomirror out\n"
      "set key bmargin center horizontal Left reverse maxcols 2 samplen 2 noenhanced\n",
      recording.name, box.least[0], box.most[0], box.least[1], box.most[1]);
  figure.commands += plot + "\n";
  return figure;
}

gnuplot::Figure relativeYawFigure(const ComparedRecording& recording) {
  gnuplot::Figure figure;
  figure.name = recording.name + "_relative_yaw";
  const std::set<double> lengths_m = lengthsOf(recording);
  if (lengths_m.empty()) return figure;
  const double step_m = smallestStep(lengths_m);
  const double slot_m = 0.8 * step_m / static_cast<double>(recording.methods.size());
  std::string plot;
  for (std::size_t i = 0; i < recording.methods.size(); ++i) {
    const double shift_m =
        (static_cast<double>(i) - 0.5 * static_cast<double>(recording.methods.size() - 1)) * slot_m;
    std::vector<std::vector<double>> rows;
    for (auto& [length_m, errors] : yawByLength(recording.methods[i])) {
      std::vector<double> sorted = errors;
      std::sort(sorted.begin(), sorted.end());
      rows.push_back({length_m + shift_m, quantile(sorted, 0.05), quantile(sorted, 0.25),
                      quantile(sorted, 0.5), quantile(sorted, 0.75), quantile(sorted, 0.95)});
    }
    if (rows.empty()) continue;
    figure.commands += gnuplot::dataBlock(fmt::format("m{}", i), rows);
    plot += fmt::format(
        "{0} $m{1} using 1:3:2:6:5 with candlesticks whiskerbars 0.5 lc '{2}' fs solid 0.3 border lc '{2}' "
        "title '{3}', $m{1} using 1:4:4:4:4 with candlesticks lc '#000000' lw 2 notitle",
        plot.empty() ? "plot" : ",", i, colourOf(i), recording.methods[i].name);
  }
  figure.commands += fmt::format(
      "set title '{}: relative yaw error over stretches of the path (median, quartiles, 5 and 95 %)' "
      "noenhanced\n"
      "set xlabel 'length of the stretch (m)'\nset ylabel 'yaw error (deg)'\nset boxwidth {}\nset xrange "
      "[0:{}]\nset yrange [0:*]\nset grid lc '#dddddd' lt 1 lw 0.7\nset border lw 0.8\nset tics nomirror "
      "out\nset bmargin 5\nset xtics ({})\nset key bmargin center horizontal samplen 2 noenhanced\n",
      recording.name, 0.85 * slot_m, *lengths_m.rbegin() + step_m, fmt::join(lengths_m, ", "));
  figure.height_px = 700;
  figure.commands += plot + "\n";
  return figure;
}

}  // namespace lodeline

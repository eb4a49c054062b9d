#include "lodeline/mapping/recognition/verification/false_alarms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace lodeline {
namespace {

double log10Choose(int n, int k) {
  return (std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0)) / std::numbers::ln10;
}

double capSolidAngle_sr(double half_angle_rad) {
  return 2.0 * std::numbers::pi * (1.0 - std::cos(half_angle_rad));
}

/// Probability that a wrong match is an inlier: the solid angle in which it would be one, over the one in
/// which it was searched. Corners are more frequent where there are others, by a factor that seldom exceeds
/// two.
double chanceOf(const LoopCorrespondence& pair, double searched_rad, const Rigid3& old_from_new,
                double view_sr) {
  constexpr double kClustering = 2.0;
  const LoopResidual residual = residualOf(pair, old_from_new, false);
  // Matches that the pose places far away are about as uncertain as their ray alone says.
  const double area_sr = residual.is_valid ? residual.direction_area_sr : std::pow(pair.ray().sigma_rad, 2);
  const double searched_sr = std::min(view_sr, capSolidAngle_sr(searched_rad));
  return std::min(1.0, kClustering * std::numbers::pi * gateOf(2) * area_sr / searched_sr);
}

struct Cell {
  double miss = 1.0;  ///< probability that none of its matches agrees by chance
  bool has_inlier = false;
};

Evidence evidenceIn(const ViewGrid& view, const std::vector<int>& features,
                    const std::vector<double>& chances, const std::vector<bool>& is_inlier) {
  std::map<int, Cell> cells;
  for (size_t i = 0; i < features.size(); ++i) {
    Cell& cell = cells[view.cellOf(features[i])];
    cell.miss *= 1.0 - chances[i];
    cell.has_inlier = cell.has_inlier || is_inlier[i];
  }
  Evidence evidence;
  for (const auto& [index, cell] : cells) {
    evidence.cells += cell.has_inlier ? 1 : 0;
    evidence.chance += (1.0 - cell.miss) / static_cast<double>(cells.size());
  }
  evidence.covered_share = static_cast<double>(evidence.cells) / view.occupiedCells();
  evidence.log10_false_alarms =
      log10FalseAlarms(static_cast<int>(cells.size()), evidence.cells, evidence.chance);
  return evidence;
}

}  // namespace

double log10FalseAlarms(int tried, int agreeing, double chance) {
  if (agreeing <= 2) return std::log10(4.0 * std::max(1, tried));
  return std::log10(4.0 * std::max(1, tried - 2)) + log10Choose(tried, agreeing) + log10Choose(agreeing, 2) +
         (agreeing - 2) * std::log10(std::max(chance, 1e-12));
}

Evidence evidenceFor(const std::vector<LoopCorrespondence>& pairs, const std::vector<double>& searched_rad,
                     const std::vector<bool>& is_inlier, const Rigid3& old_from_new, const ViewGrid& old_view,
                     const ViewGrid& new_view) {
  std::vector<int> old_features, new_features;
  std::vector<double> chances;
  for (size_t i = 0; i < pairs.size(); ++i) {
    old_features.push_back(pairs[i].match.old_feature);
    new_features.push_back(pairs[i].match.new_feature);
    const ViewGrid& searched = pairs[i].is_point_old ? new_view : old_view;
    chances.push_back(chanceOf(pairs[i], searched_rad[i], old_from_new, searched.solidAngle_sr()));
  }
  const Evidence in_old = evidenceIn(old_view, old_features, chances, is_inlier);
  const Evidence in_new = evidenceIn(new_view, new_features, chances, is_inlier);
  Evidence evidence = in_old.log10_false_alarms > in_new.log10_false_alarms ? in_old : in_new;
  evidence.cells = std::min(in_old.cells, in_new.cells);
  evidence.covered_share = std::min(in_old.covered_share, in_new.covered_share);
  return evidence;
}

}  // namespace lodeline

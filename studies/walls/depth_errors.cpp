#include "studies/walls/depth_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace lodeline {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Rows of a table: one for each class of depths.
class Classes {
 public:
  void add(const std::string& name, std::vector<DepthError> errors) {
    if (errors.size() < 20) return;
    std::vector<double> along, across, ratio;
    for (const DepthError& error : errors) {
      along.push_back(error.along_m);
      across.push_back(std::abs(error.across_m()));
      ratio.push_back(std::abs(error.along_m) / error.sigma_m);
    }
    std::sort(along.begin(), along.end());
    std::sort(across.begin(), across.end());
    std::sort(ratio.begin(), ratio.end());
    const auto share = [&](double limit_m) {
      const auto within = std::upper_bound(across.begin(), across.end(), limit_m) - across.begin();
      return 100.0 * static_cast<double>(within) / static_cast<double>(across.size());
    };
    text_ += fmt::format("{:<22}{:>9}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}\n", name, errors.size(),
                         100.0 * quantile(along, 0.5),
                         100.0 / 1.349 * (quantile(along, 0.75) - quantile(along, 0.25)),
                         quantile(ratio, 0.683), share(0.02), share(0.04), share(0.10));
  }
  std::string text() const { return text_; }

 private:
  std::string text_ = fmt::format("{:<22}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "depths", "number", "median",
                                  "sigma", "/claimed", "% 2 cm", "% 4 cm", "% 10 cm");
};

template <typename Value>
void addRanges(const std::vector<DepthError>& errors, const char* unit, const std::vector<double>& limits,
               const Value& value, Classes* classes) {
  for (size_t i = 0; i + 1 < limits.size(); ++i) {
    std::vector<DepthError> chosen;
    std::copy_if(errors.begin(), errors.end(), std::back_inserter(chosen), [&](const DepthError& error) {
      return value(error) >= limits[i] && value(error) < limits[i + 1];
    });
    classes->add(fmt::format("{:g} to {:g} {}", limits[i], limits[i + 1], unit), chosen);
  }
}

/// RMS of the means of places, and of the differences from them.
std::string sharedPart(const std::vector<DepthError>& errors) {
  constexpr double kCell_m = 0.1, kOutlier_m = 0.3;
  constexpr size_t kLeast = 8;
  std::map<std::array<int, 3>, std::vector<double>> cells;
  for (const DepthError& error : errors) {
    if (std::abs(error.across_m()) > kOutlier_m) continue;
    const Eigen::Vector3i cell = (error.place / kCell_m).array().floor().cast<int>();
    cells[{cell.x(), cell.y(), cell.z()}].push_back(error.across_m());
  }
  double means = 0.0, differences = 0.0;
  size_t places = 0, depths = 0;
  for (const auto& [cell, values] : cells) {
    if (values.size() < kLeast) continue;
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (const double value : values) differences += (value - mean) * (value - mean);
    means += mean * mean;
    ++places;
    depths += values.size();
  }
  return fmt::format(
      "across the surface, {} places of 10 cm: mean {:.1f} cm RMS, differences {:.1f} cm RMS\n", places,
      100.0 * std::sqrt(means / static_cast<double>(std::max<size_t>(1, places))),
      100.0 * std::sqrt(differences / static_cast<double>(std::max<size_t>(1, depths))));
}

}  // namespace

std::vector<DepthError> depthErrors(
    const DepthKeyframes& frames, const TrueSurface& truth, int step_px,
    const std::function<std::optional<Rigid3>(const DepthKeyframe&)>& world_from_view) {
  std::vector<DepthError> errors;
  for (const DepthKeyframe& keyframe : frames.keyframes) {
    const std::optional<Rigid3> pose = world_from_view(keyframe);
    if (!pose) continue;
    const DepthImage image = frames.depths(keyframe.number);
    for (int v = step_px / 2; v < image.depth.rows; v += step_px) {
      for (int u = step_px / 2; u < image.depth.cols; u += step_px) {
        if (image.depth_m(u, v) <= 0.0) continue;
        const Vec3 sight = pose->rotation * (image.depth_m(u, v) * frames.pinhole.direction(u, v));
        const auto hit = truth.hit(pose->translation, sight.normalized());
        if (!hit) continue;
        errors.push_back({image.depth_m(u, v), image.sigma_m(u, v), sight.norm() - hit->range_m,
                          hit->incidence_rad, pose->translation + hit->range_m * sight.normalized()});
      }
    }
  }
  return errors;
}

std::string depthErrorTables(const std::vector<DepthError>& errors) {
  Classes classes;
  classes.add("all", errors);
  addRanges(
      errors, "m", {0.0, 1.5, 2.5, 3.5, 4.5, 6.5}, [](const DepthError& e) { return e.depth_m; }, &classes);
  addRanges(
      errors, "deg", {0.0, 30.0, 50.0, 70.0, 90.0},
      [](const DepthError& e) { return e.incidence_rad / kDegree; }, &classes);
  return classes.text() + sharedPart(errors);
}

}  // namespace lodeline

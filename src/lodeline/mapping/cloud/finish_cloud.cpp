#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lodeline/mapping/cloud/cloud_index.h"
#include "lodeline/mapping/cloud/local_cloud.h"
#include "lodeline/mapping/cloud/local_plane.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr size_t kIsolationNeighbours = 6;

std::vector<Vec3> positionsIn(const LocalCloud& cloud) {
  std::vector<Vec3> positions;
  for (const CloudPoint& point : cloud.points) positions.push_back(point.position_F);
  return positions;
}

/// Keeps the most certain point of each cube. The cubes' order is that of their coordinates.
void thin(LocalCloud& cloud, double voxel_m) {
  std::map<std::array<int, 3>, size_t> best;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    std::array<int, 3> cube;
    for (size_t axis = 0; axis < 3; ++axis)
      cube[axis] =
          static_cast<int>(std::floor(cloud.points[i].position_F[static_cast<Eigen::Index>(axis)] / voxel_m));
    const auto [place, is_new] = best.try_emplace(cube, i);
    if (!is_new && cloud.points[i].covariance_F.trace() < cloud.points[place->second].covariance_F.trace())
      place->second = i;
  }
  std::vector<CloudPoint> kept;
  for (const auto& [cube, i] : best) kept.push_back(cloud.points[i]);
  cloud.points = std::move(kept);
}

/// Removes points whose mean distance to their neighbours exceeds the median by more than three robust
/// standard deviations (1.4826 times the median absolute deviation). R. B. Rusu et al., "Towards 3D point
/// cloud based object maps for household environments", 2008, with a robust scale.
void removeIsolated(LocalCloud& cloud) {
  if (cloud.points.size() <= kIsolationNeighbours) return;
  const CloudIndex index(positionsIn(cloud));
  std::vector<double> spacings;
  std::vector<Neighbour> found;
  for (const CloudPoint& point : cloud.points) {
    index.find(point.position_F, kIsolationNeighbours + 1, found);
    double sum = 0.0;
    for (const Neighbour& neighbour : found) sum += std::sqrt(neighbour.squared_distance);
    spacings.push_back(sum / kIsolationNeighbours);
  }
  const double median = lodeline::median(spacings);
  std::vector<double> deviations;
  for (const double spacing : spacings) deviations.push_back(std::abs(spacing - median));
  // The corner of a regular grid has 1.4 times the spacing of its middle.
  const double limit = std::max(median + 3.0 * 1.4826 * lodeline::median(deviations), 1.5 * median);
  std::vector<CloudPoint> kept;
  for (size_t i = 0; i < spacings.size(); ++i) {
    if (spacings[i] <= limit) kept.push_back(cloud.points[i]);
  }
  cloud.points = std::move(kept);
}

void giveNormals(LocalCloud& cloud, int neighbours) {
  constexpr double kLeastFlatness = 0.6;
  const CloudIndex index(positionsIn(cloud));
  std::vector<Neighbour> work;
  for (CloudPoint& point : cloud.points) {
    point.normal_F.setZero();
    const auto plane = fitLocalPlane(cloud, index, point.position_F, neighbours, work);
    if (!plane || plane->flatness < kLeastFlatness) continue;
    // Of a plane that several cameras saw, this point's camera decides the side.
    point.normal_F = plane->normal.dot(point.view_F) > 0.0 ? Vec3(-plane->normal) : plane->normal;
    point.thickness_m = std::sqrt(plane->thickness_squared_m2);
    point.tilt_sigma_rad = std::sqrt(plane->tilt_covariance.trace() / 2.0);
  }
}

}  // namespace

void finishCloud(LocalCloud& cloud, const LocalCloudOptions& options) {
  thin(cloud, options.voxel_m);
  removeIsolated(cloud);
  giveNormals(cloud, options.neighbours);
}

}  // namespace lodeline

#include "simulation/rendering/light/haze_volume.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

// Steps grow geometrically, because most of the haze is within a metre of the lamps.
constexpr float kFirstStep_m = 0.08f;
constexpr float kGrowth = 1.21f;
constexpr float kOpaque = 7.0f;  // optical depth with a transmittance of a thousandth
const float kPerLogGrowth = 1.0f / std::log2(kGrowth);

/// Light scattered towards the camera per metre at a point, before attenuation on the way to the camera.
float inScatter(const LightField& light, const Water::Coefficients& water, const Vec3f& point,
                const Vec3f& view) {
  float sum = 0.0f;
  for (const PlacedLamp& lamp : light.lamps) {
    const Vec3f to_lamp = lamp.position() - point;
    // The reflector of a lamp has a width, so there is no singularity at its centre.
    const float distance = std::sqrt(to_lamp.squaredNorm() + 0.03f * 0.03f);
    const Vec3f towards = to_lamp / distance;
    // The light propagates along -towards and is scattered into -view.
    sum += light.water.phase(towards.dot(view), water.scattering) * lamp.irradiance(towards, distance) *
           fastExp(-water.diffuse_attenuation * distance);
  }
  // Daylight arrives from all directions: isotropic.
  sum += light.daylight.inWater(point) / (4.0f * std::numbers::pi_v<float>);
  return water.scattering * sum;
}

}  // namespace

HazeVolume::HazeVolume(const LightField& light, const Vec3f& origin_W, const std::vector<Vec3f>& directions_W,
                       int columns)
    : columns_(columns),
      rows_(static_cast<int>(directions_W.size()) / columns),
      entries_(directions_W.size() * kSteps) {
  for (int k = 0; k < kSteps; ++k) step_range_m_[k] = kFirstStep_m * std::pow(kGrowth, static_cast<float>(k));
  tbb::parallel_for(0, rows_, [&](int row) {
    for (int node = row * columns_; node < (row + 1) * columns_; ++node) {
      march(light, origin_W, directions_W[node], &entries_[static_cast<size_t>(node) * kSteps]);
    }
  });
}

void HazeVolume::march(const LightField& light, const Vec3f& origin_W, const Vec3f& direction_W,
                       Entry* entries) const {
  Entry sum;
  float from = 0.0f, diffuse_depth = 0.0f;
  Water::Coefficients water = light.water.at(origin_W);
  for (int k = 0; k < kSteps; ++k) {
    if (diffuse_depth > kOpaque) {
      entries[k] = sum;
      continue;
    }
    const float step = step_range_m_[k] - from;
    const Vec3f middle = origin_W + (from + 0.5f * step) * direction_W;
    if (!light.water.uniform()) water = light.water.at(middle);
    const float half_depth = diffuse_depth + 0.5f * step * water.diffuse_attenuation;
    sum.radiance += step * inScatter(light, water, middle, direction_W) * fastExp(-half_depth);
    sum.optical_depth += step * water.attenuation;
    diffuse_depth += step * water.diffuse_attenuation;
    entries[k] = sum;
    from = step_range_m_[k];
  }
}

HazeSample HazeVolume::at(float x_px, float y_px, float range_m) const {
  const float gx = x_px / kNodeSpacing_px, gy = y_px / kNodeSpacing_px;
  const int ix = std::min(static_cast<int>(gx), columns_ - 2), iy = std::min(static_cast<int>(gy), rows_ - 2);
  const float fx = gx - ix, fy = gy - iy;

  const float range = std::min(range_m, step_range_m_[kSteps - 1]);
  int step = 0;
  float t = range / step_range_m_[0];  // within the first step, all values increase from zero
  if (t > 1.0f) {
    step = std::min(kSteps - 1, 1 + static_cast<int>(roughLog2(t) * kPerLogGrowth));
    // The logarithm is approximate: a range just beyond the border of its step is on the extrapolated line.
    t = (range - step_range_m_[step - 1]) / (step_range_m_[step] - step_range_m_[step - 1]);
  }
  Entry sum;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const Entry* entry = &entries_[static_cast<size_t>((iy + dy) * columns_ + ix + dx) * kSteps + step];
    const float weight = (dx ? fx : 1.0f - fx) * (dy ? fy : 1.0f - fy);
    const Entry before = step > 0 ? entry[-1] : Entry{};
    sum.optical_depth += weight * lerp(before.optical_depth, entry->optical_depth, t);
    sum.radiance += weight * lerp(before.radiance, entry->radiance, t);
  }
  return {fastExp(-sum.optical_depth), sum.radiance};
}

}  // namespace lodeline

#include "simulation/rendering/optics/dispersion.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "simulation/rendering/optics/sampling.h"
#include "simulation/rendering/optics/water_index.h"

namespace lodeline {
namespace {

constexpr int kSpacing_px = 16;
constexpr double kReferenceRange_m = 2.0;
constexpr float kFarthest_m = 15.0f;

/// Weights of the four nodes about a position, and the index of the first.
struct Bilinear {
  Bilinear(double x_px, double y_px, int columns, int rows) {
    const float gx = static_cast<float>(x_px) / kSpacing_px, gy = static_cast<float>(y_px) / kSpacing_px;
    const int ix = std::clamp(static_cast<int>(gx), 0, columns - 2);
    const int iy = std::clamp(static_cast<int>(gy), 0, rows - 2);
    const float fx = gx - static_cast<float>(ix), fy = gy - static_cast<float>(iy);
    first = iy * columns + ix;
    weights = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  }
  int first;
  std::array<float, 4> weights;
};

}  // namespace

Dispersion::Dispersion(const CameraOptics& optics)
    : columns_((optics.width() + kSpacing_px - 1) / kSpacing_px + 1),
      rows_((optics.height() + kSpacing_px - 1) / kSpacing_px + 1),
      nodes_(static_cast<size_t>(columns_) * rows_) {
  const PortWindow& port = *optics.port();
  const double middle = waterIndexAt(0.0, 25.0, kMiddleWavelength_nm);
  for (size_t b = 0; b < kSpectralBands.size(); ++b) {
    const double wavelength_nm = kSpectralBands[b].wavelength_nm;
    const PortWindow of_band =
        withIndices(port, glassIndex(port) + acrylicDispersion(wavelength_nm),
                    waterIndex(port) + waterIndexAt(0.0, 25.0, wavelength_nm) - middle);
    tbb::parallel_for(0, rows_, [&](int row) {
      for (int column = 0; column < columns_; ++column) {
        const Vec2 pixel(column * kSpacing_px, row * kSpacing_px);
        auto& node = nodes_[static_cast<size_t>(row) * columns_ + column][b];
        node.setZero();
        const auto ray = optics.ray(pixel, of_band);
        if (!ray) continue;
        const auto same = optics.pixelOf(ray->origin_C + kReferenceRange_m * ray->direction_C, pixel);
        if (same) node = (*same - pixel).cast<float>();
      }
    });
  }
}

Dispersion::Weights Dispersion::weightsAt(float range_m) {
  // The light passes the water twice, from the lamp to the wall and back.
  const float path_m = 2.0f * std::min(range_m, kFarthest_m);
  Weights weights;
  float sum = 0.0f;
  for (size_t b = 0; b < weights.size(); ++b) {
    weights[b] = kSpectralBands[b].response * std::exp(-kSpectralBands[b].absorption_per_m * path_m);
    sum += weights[b];
  }
  for (float& weight : weights) weight /= sum;
  return weights;
}

Vec2 Dispersion::shift(int band, double x_px, double y_px) const {
  const Bilinear at(x_px, y_px, columns_, rows_);
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (int corner = 0; corner < 4; ++corner) {
    sum += at.weights[corner] * nodes_[at.first + (corner >> 1) * columns_ + (corner & 1)][band];
  }
  return sum.cast<double>();
}

Vec2 Dispersion::meanShift(double x_px, double y_px, float range_m) const {
  const Weights weights = weightsAt(range_m);
  Vec2 sum = Vec2::Zero();
  for (size_t b = 0; b < weights.size(); ++b) sum += weights[b] * shift(static_cast<int>(b), x_px, y_px);
  return sum;
}

void Dispersion::smear(cv::Mat& radiance, const cv::Mat& range_m) const {
  const cv::Mat sharp = radiance.clone();
  // Weights change slowly with the distance: a table over its logarithm.
  constexpr int kSteps = 64;
  std::array<Weights, kSteps> table;
  for (int i = 0; i < kSteps; ++i) table[i] = weightsAt(0.25f * static_cast<float>(i));
  tbb::parallel_for(0, radiance.rows, [&](int y) {
    const float* ranges = range_m.ptr<float>(y);
    float* out = radiance.ptr<float>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      const int step = static_cast<int>(4.0f * std::min(ranges[x], kFarthest_m));
      float sum = 0.0f;
      for (size_t b = 0; b < kSpectralBands.size(); ++b) {
        const Vec2 from = shift(static_cast<int>(b), x, y);
        sum += table[step][b] *
               bilinear(sharp, static_cast<float>(x + from.x()), static_cast<float>(y + from.y()));
      }
      out[x] = sum;
    }
  });
}

}  // namespace lodeline

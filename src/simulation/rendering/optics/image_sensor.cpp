#include "simulation/rendering/optics/image_sensor.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/rendering/optics/pixel_hash.h"

namespace lodeline {
namespace {

constexpr int kToneSteps = 8192;

/// Table of grey values for light of 0..1 relative to white. The square root as index resolves the steep
/// start of the curve.
std::array<uint8_t, kToneSteps + 1> toneTable(double gamma) {
  std::array<uint8_t, kToneSteps + 1> table;
  for (int i = 0; i <= kToneSteps; ++i) {
    const double root = static_cast<double>(i) / kToneSteps;
    table[i] = static_cast<uint8_t>(std::lround(255.0 * std::pow(root * root, gamma)));
  }
  return table;
}

}  // namespace

ExposureSetting splitExposure(const SensorOptions& sensor, double wanted_s) {
  ExposureSetting setting;
  setting.exposure_s = std::clamp(wanted_s, sensor.shortest_exposure_s, sensor.longest_exposure_s);
  setting.gain = std::clamp(wanted_s / setting.exposure_s, 1.0, sensor.highest_gain);
  return setting;
}

double meteredExposure(const SensorOptions& sensor, const std::vector<float>& radiances) {
  const double white_per_s = sensor.electrons_per_radiance_s / sensor.full_well_e;
  const auto meanGrey = [&](double exposure_s) {
    double sum = 0.0;
    for (const float radiance : radiances) {
      sum += std::pow(std::min(1.0, white_per_s * exposure_s * radiance), sensor.gamma);
    }
    return sum / static_cast<double>(radiances.size());
  };
  double low = std::log(sensor.shortest_exposure_s);
  double high = std::log(sensor.longest_exposure_s * sensor.highest_gain);
  for (int i = 0; i < 14; ++i) {
    const double middle = 0.5 * (low + high);
    (meanGrey(std::exp(middle)) < sensor.target_grey ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

cv::Mat develop(const cv::Mat& radiance, const SensorOptions& sensor, const ExposureSetting& setting,
                uint64_t noise_seed) {
  const auto tone = toneTable(sensor.gamma);
  const float electrons = static_cast<float>(sensor.electrons_per_radiance_s * setting.exposure_s);
  const float per_white = static_cast<float>(setting.gain / sensor.full_well_e);
  const float read_variance = static_cast<float>(sensor.read_noise_e * sensor.read_noise_e);
  const float full_well = static_cast<float>(sensor.full_well_e);
  cv::Mat grey(radiance.size(), CV_8U);
  tbb::parallel_for(0, radiance.rows, [&](int y) {
    const float* from = radiance.ptr<float>(y);
    uint8_t* to = grey.ptr<uint8_t>(y);
    for (int x = 0; x < radiance.cols; ++x) {
      float signal = electrons * from[x];
      if (sensor.noise) {
        const uint64_t pixel = static_cast<uint64_t>(y) * static_cast<uint64_t>(radiance.cols) + x;
        signal += std::sqrt(signal + read_variance) * roughNormalFromHash(scrambleBits(noise_seed + pixel));
      }
      const float light = std::clamp(std::min(signal, full_well) * per_white, 0.0f, 1.0f);
      to[x] = tone[static_cast<int>(std::sqrt(light) * kToneSteps + 0.5f)];
    }
  });
  return grey;
}

}  // namespace lodeline

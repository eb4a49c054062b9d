#include "lodeline/imu/noise/vibration_survey.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "lodeline/imu/noise/imu_noise_check.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kVibrationBlock_s = 0.5;
constexpr size_t kFewestBlocks = 10;

struct VibrationBlock {
  double sigma;
  size_t begin, count;
};

double sigmaOf(std::span<const ImuSample> block, Vec3 ImuSample::*reading) {
  double squares = 0.0;
  for (size_t i = 2; i < block.size(); ++i)
    squares += (block[i].*reading - 2.0 * block[i - 1].*reading + block[i - 2].*reading).squaredNorm();
  return std::sqrt(squares / (18.0 * static_cast<double>(block.size() - 2)));
}

/// Frequency with the most energy in the first differences, by the discrete Fourier transform. Below 5 Hz is
/// motion.
double strongestLine_hz(std::span<const ImuSample> block, Vec3 ImuSample::*reading, double step_s) {
  constexpr double kSlowest_hz = 5.0, kSpacing_hz = 1.0;
  double best = 0.0, best_hz = 0.0;
  for (double hz = kSlowest_hz; hz <= 0.5 / step_s; hz += kSpacing_hz) {
    double energy = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      std::complex<double> sum = 0.0;
      for (size_t i = 1; i < block.size(); ++i) {
        const double change = (block[i].*reading)[axis] - (block[i - 1].*reading)[axis];
        sum += change * std::polar(1.0, -2.0 * std::numbers::pi * hz * step_s * static_cast<double>(i));
      }
      energy += std::norm(sum);
    }
    // Differences amplify a frequency by 2 sin(pi f h).
    energy /= std::pow(std::sin(std::numbers::pi * hz * step_s), 2);
    if (energy <= best) continue;
    best = energy;
    best_hz = hz;
  }
  return best_hz;
}

}  // namespace

Vibration surveyVibration(std::span<const ImuSample> samples, Vec3 ImuSample::*reading, double limit) {
  Vibration result;
  if (samples.size() < 3) return result;
  const double step_s = medianStep_s(samples);
  if (!(step_s > 0.0)) return result;
  const auto size = static_cast<size_t>(kVibrationBlock_s / step_s);
  if (size < 8) return result;
  std::vector<VibrationBlock> blocks;
  for (size_t begin = 0; begin + size <= samples.size(); begin += size) {
    const std::span<const ImuSample> block = samples.subspan(begin, size);
    // Not across gaps.
    if ((block.back().time - block.front().time).seconds() > 1.2 * step_s * static_cast<double>(size))
      continue;
    blocks.push_back({sigmaOf(block, reading), begin, size});
  }
  if (blocks.size() < kFewestBlocks) return result;
  const auto beyond = std::count_if(blocks.begin(), blocks.end(),
                                    [limit](const VibrationBlock& block) { return block.sigma > limit; });
  std::stable_sort(blocks.begin(), blocks.end(),
                   [](const VibrationBlock& a, const VibrationBlock& b) { return a.sigma < b.sigma; });
  const VibrationBlock& strong = blocks[blocks.size() * 9 / 10];
  result.strong = strong.sigma;
  result.quiet = blocks[blocks.size() / 10].sigma;
  result.share = static_cast<double>(beyond) / static_cast<double>(blocks.size());
  result.frequency_hz = strongestLine_hz(samples.subspan(strong.begin, strong.count), reading, step_s);
  result.rate_hz = 1.0 / step_s;
  return result;
}

}  // namespace lodeline

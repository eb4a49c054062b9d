#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "lodeline/types.h"

namespace lodeline::test {

/// True parameters of a simulated sensor: readings y with |A (y - h)| = 1 and white noise.
struct CloudTruth {
  Mat3 correction = (Mat3() << 1.05, 0.04, -0.02, 0.04, 0.93, 0.05, -0.02, 0.05, 1.1).finished();  ///< A
  Vec3 hard_iron = Vec3(0.3, -0.2, 0.5);
  double sigma = 0.0;  ///< per axis
  unsigned seed = 1;
  /// Restricts directions to those whose cosine with this axis is at least `least_cosine`.
  Vec3 towards = Vec3::UnitZ();
  double least_cosine = -1.0;
};

/// `count` readings whose directions follow a sunflower pattern on the (part of the) sphere.
inline std::vector<Vec3> cloud(const CloudTruth& truth, int count) {
  std::mt19937_64 engine(truth.seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Mat3 soft_iron = truth.correction.inverse();
  const Quat turn = Quat::FromTwoVectors(Vec3::UnitZ(), truth.towards);
  std::vector<Vec3> readings;
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (1.0 - truth.least_cosine) * (i + 0.5) / count;
    const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double angle = 2.399963 * i;
    const Vec3 direction = turn * Vec3(r * std::cos(angle), r * std::sin(angle), z);
    const double x = normal(engine), y = normal(engine), w = normal(engine);
    readings.push_back(soft_iron * direction + truth.hard_iron + truth.sigma * Vec3(x, y, w));
  }
  return readings;
}

}  // namespace lodeline::test

#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Simulated readings of three axes with known noise (two-sided densities) for tests. Flicker noise is a sum
/// of Gauss-Markov processes.
class TestNoise {
 public:
  TestNoise(double white, double instability, double walk, double rate_hz, unsigned seed)
      : engine_(seed), white_(white * std::sqrt(rate_hz)), walk_(walk / std::sqrt(rate_hz)) {
    if (instability == 0.0) return;
    const double sigma = instability * std::sqrt(0.5 * std::numbers::ln10 / std::numbers::pi);
    for (double time_s = 0.02; time_s < 2e4; time_s *= std::sqrt(10.0)) {
      const double keep = std::exp(-1.0 / (rate_hz * time_s));
      processes_.push_back({keep, sigma * std::sqrt(1.0 - keep * keep), sigma * normal3()});
    }
  }

  Vec3 next() {
    walked_ += walk_ * normal3();
    Vec3 reading = walked_ + white_ * normal3();
    for (Process& p : processes_) {
      p.value = p.keep * p.value + p.drive * normal3();
      reading += p.value;
    }
    return reading;
  }

 private:
  struct Process {
    double keep, drive;
    Vec3 value;
  };
  Vec3 normal3() {
    const double x = normal_(engine_), y = normal_(engine_), z = normal_(engine_);
    return {x, y, z};
  }

  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
  double white_, walk_;
  Vec3 walked_ = Vec3::Zero();
  std::vector<Process> processes_;
};

}  // namespace lodeline

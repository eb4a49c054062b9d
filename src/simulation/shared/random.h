#pragma once

#include <cstdint>
#include <random>
#include <string_view>

#include "lodeline/types.h"

namespace lodeline {

/// Random numbers that are equal on every machine. The standard defines std::mt19937_64, but not the
/// algorithms of its distributions, which are therefore implemented here.
///
/// Every sensor and effect draws from its own stream of one scenario seed, so switching one off does not
/// change the draws of the others.
class Random {
 public:
  Random(uint64_t seed, std::string_view stream);

  uint64_t next() { return engine_(); }
  /// In [0, 1), 53 random bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  int index(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }
  /// -1 or +1.
  double sign() { return chance(0.5) ? -1.0 : 1.0; }
  /// Standard normal, Box-Muller.
  double normal();
  Vec3 normal3();
  /// Uniform on the unit sphere.
  Vec3 direction();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace lodeline

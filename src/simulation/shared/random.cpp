#include "simulation/shared/random.h"

#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

// Seed and stream name are hashed together (FNV-1a, then the finalizer of splitmix64), so that neighbouring
// seeds give unrelated sequences.
uint64_t hashed(uint64_t seed, std::string_view stream) {
  uint64_t hash = 14695981039346656037ull ^ seed;
  for (const char c : stream) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  hash += 0x9e3779b97f4a7c15ull;
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9ull;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebull;
  return hash ^ (hash >> 31);
}

}  // namespace

Random::Random(uint64_t seed, std::string_view stream) : engine_(hashed(seed, stream)) {}

double Random::uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  const double angle = 2.0 * std::numbers::pi * uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Vec3 Random::normal3() {
  // Separate variables, because the order of evaluation of function arguments is unspecified.
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return Vec3(x, y, z);
}

Vec3 Random::direction() { return normal3().normalized(); }

}  // namespace lodeline

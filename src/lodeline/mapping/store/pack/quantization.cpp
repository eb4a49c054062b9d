#include "lodeline/mapping/store/pack/quantization.h"

#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kLargestError = 4.3;  ///< over the number of steps: the largest error
constexpr double kSigmaStep = 0.1;
constexpr double kLeastDistance_m = 1e-3;
constexpr double kStepsPerSigma = 2.0;
constexpr int kMostSteps = 7;  ///< to each side

double signOf(double value) { return value < 0.0 ? -1.0 : 1.0; }

}  // namespace

DirectionGrid DirectionGrid::forSigma(double sigma_rad) {
  const double steps = std::ceil(4.0 * kLargestError / sigma_rad);
  return DirectionGrid(static_cast<uint16_t>(std::clamp(steps, 1024.0, 65535.0)));
}

std::array<uint16_t, 2> DirectionGrid::pack(const Vec3& direction) const {
  Vec2 place = direction.head<2>() / direction.lpNorm<1>();
  if (direction.z() < 0.0) {
    place = Vec2((1.0 - std::abs(place.y())) * signOf(place.x()),
                 (1.0 - std::abs(place.x())) * signOf(place.y()));
  }
  const auto steps = [&](double value) {
    return static_cast<uint16_t>(std::lround(0.5 * (std::clamp(value, -1.0, 1.0) + 1.0) * steps_));
  };
  return {steps(place.x()), steps(place.y())};
}

Vec3 DirectionGrid::unpack(uint16_t u, uint16_t v) const {
  const double x = 2.0 * u / steps_ - 1.0, y = 2.0 * v / steps_ - 1.0;
  const double z = 1.0 - std::abs(x) - std::abs(y);
  if (z >= 0.0) return Vec3(x, y, z).normalized();
  return Vec3((1.0 - std::abs(y)) * signOf(x), (1.0 - std::abs(x)) * signOf(y), z).normalized();
}

uint8_t packSigma(double sigma, double least) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::log(sigma / least) / kSigmaStep, 0.0, 255.0)));
}

double unpackSigma(uint8_t code, double least) { return least * std::exp(kSigmaStep * code); }

DistanceScale DistanceScale::forSigma(double relative_sigma) {
  return DistanceScale(std::clamp(0.25 * relative_sigma, 0.001, 0.02));
}

std::optional<uint16_t> DistanceScale::pack(double distance_m) const {
  if (!(distance_m >= kLeastDistance_m)) return std::nullopt;
  const double code = std::round(std::log(distance_m / kLeastDistance_m) / step_);
  if (code > 65535.0) return std::nullopt;
  return static_cast<uint16_t>(code);
}

double DistanceScale::unpack_m(uint16_t code) const { return kLeastDistance_m * std::exp(step_ * code); }

std::optional<uint8_t> packResidual(const Vec3& direction, const Vec3& predicted, double sigma_rad) {
  const double along = direction.dot(predicted);
  if (!(along > 0.5)) return std::nullopt;
  const Vec2 steps = tangentBasis(predicted).transpose() * direction * (kStepsPerSigma / (along * sigma_rad));
  if (!(steps.cwiseAbs().maxCoeff() < kMostSteps + 0.5)) return std::nullopt;
  const auto nibble = [](double value) { return static_cast<int>(std::lround(value)) + kMostSteps; };
  return static_cast<uint8_t>(nibble(steps.x()) | nibble(steps.y()) << 4);
}

Vec3 unpackResidual(uint8_t code, const Vec3& predicted, double sigma_rad) {
  const Vec2 steps((code & 0x0f) - kMostSteps, (code >> 4) - kMostSteps);
  return (predicted + tangentBasis(predicted) * steps * (sigma_rad / kStepsPerSigma)).normalized();
}

}  // namespace lodeline

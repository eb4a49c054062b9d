#include "simulation/rendering/light/second_diver.h"

#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"

namespace lodeline {

std::optional<PlacedLamp> placeSecondDiver(const SecondDiver& diver, const Vec3& rig_position_W,
                                           const Vec3& forward_W, double time_s, uint64_t seed) {
  const uint32_t noise_seed = static_cast<uint32_t>(seed);
  const auto wander = [&](double rate_hz, uint32_t channel) {
    return gradientNoise(Vec3f(static_cast<float>(time_s * rate_hz), 0.37f, 0.71f), noise_seed + channel);
  };
  // Slow noise of about +-0.5, blended in and out over its last tenth, so that the presence has no step.
  const float margin = wander(1.0 / 25.0, 51) + static_cast<float>(diver.visible_share - 0.5);
  const double presence = smoothStep(-0.05f, 0.05f, margin);
  if (presence <= 0.0) return std::nullopt;

  Vec3 level = Vec3(forward_W.x(), forward_W.y(), 0.0);
  level = level.norm() > 0.05 ? Vec3(level.normalized()) : Vec3(Vec3::UnitX());
  const Vec3 left = Vec3::UnitZ().cross(level);
  const double phase = 2.0 * std::numbers::pi * time_s / diver.period_s;
  const double yaw = diver.sweep_rad * (0.7 * std::sin(phase) + 0.9 * wander(0.4, 52));
  const double pitch = 0.5 * diver.sweep_rad * (0.5 * std::sin(0.63 * phase + 1.0) + 0.9 * wander(0.5, 53));

  Lamp torch;
  torch.position_B = rig_position_W + diver.position_B.x() * level + diver.position_B.y() * left +
                     diver.position_B.z() * Vec3::UnitZ();
  torch.direction_B =
      std::cos(pitch) * (std::cos(yaw) * level + std::sin(yaw) * left) + std::sin(pitch) * Vec3::UnitZ();
  torch.spot_intensity = diver.spot_intensity * presence;
  torch.spot_half_angle_rad = diver.spot_half_angle_rad;
  torch.flood_intensity = 0.04 * torch.spot_intensity;
  return PlacedLamp(torch, Rigid3());
}

}  // namespace lodeline

#include "simulation/rendering/light/water.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/rendering/cave/gradient_noise.h"

namespace lodeline {

double siltAttenuation(const SiltEpisode& episode, double time_s) {
  const double phase = (time_s - episode.start_s) / episode.duration_s;
  if (phase <= 0.0 || phase >= 1.0) return 0.0;
  const float shape =
      smoothStep(0.0f, 0.25f, static_cast<float>(phase)) * smoothStep(1.0f, 0.55f, static_cast<float>(phase));
  return episode.peak_attenuation_per_m * shape;
}

Water::Water(const WaterOptions& options, double time_s, uint64_t seed)
    : clear_per_m_(static_cast<float>(options.attenuation_per_m)),
      scattering_share_(static_cast<float>(options.scattering_share)),
      asymmetry_(static_cast<float>(options.asymmetry)),
      patchiness_(static_cast<float>(options.patchiness)),
      drift_m_(static_cast<float>(options.drift_speed_m_per_s * time_s) * Vec3f(0.8f, -0.5f, 0.1f)),
      seed_(static_cast<uint32_t>(seed)) {
  if (options.current) drift_m_ = options.current->at(time_s).cast<float>();
  for (const SiltEpisode& episode : options.silt) {
    silt_per_m_ += static_cast<float>(siltAttenuation(episode, time_s));
  }
}

Water::Coefficients Water::at(const Vec3f& point_W) const {
  float clear = clear_per_m_, silt = silt_per_m_;
  if (!uniform()) {
    const float cloud = fractalNoise((point_W - drift_m_) / 0.8f, 2, seed_ + 61, 0.6f);
    clear *= std::max(0.2f, 1.0f + patchiness_ * 1.8f * cloud);
    // Clouds: dense at some places, nearly clear at others.
    silt *= std::max(0.05f, 1.0f + 2.0f * cloud);
  }
  return coefficients(clear, silt);
}

Water::Coefficients Water::coefficients(float clear_per_m, float silt_per_m) const {
  // Mineral silt absorbs little: nine tenths of its attenuation is scattering.
  const float scattering = scattering_share_ * clear_per_m + 0.9f * silt_per_m;
  const float attenuation = clear_per_m + silt_per_m;
  return {attenuation, scattering, attenuation - asymmetry_ * scattering};
}

float Water::phase(float cosine, float scattering_per_m) const {
  const float g = asymmetry_;
  const float base = 1.0f + g * g - 2.0f * g * cosine;
  const float forward = (1.0f - g * g) / (base * std::sqrt(base));
  const float squared = scattering_per_m * scattering_per_m, fourth = squared * squared;
  return lerp(forward, 1.0f, fourth / (fourth + 1.0f)) / (4.0f * std::numbers::pi_v<float>);
}

}  // namespace lodeline

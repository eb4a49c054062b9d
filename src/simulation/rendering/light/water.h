#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "simulation/rendering/optics/render_types.h"
#include "simulation/shared/track.h"

namespace lodeline {

/// A time interval in which stirred-up silt increases the attenuation.
struct SiltEpisode {
  double start_s = 0.0;
  double duration_s = 5.0;
  double peak_attenuation_per_m = 2.0;  ///< maximum increase
};

/// Optical properties of the water in one grey band.
struct WaterOptions {
  double attenuation_per_m = 0.10;  ///< c in Beer-Lambert's exp(-c r), absorption and scattering together
  double scattering_share = 0.6;    ///< b / c, single-scattering albedo of the water itself
  double asymmetry = 0.88;          ///< Henyey-Greenstein's g, the mean cosine of scattering
  double patchiness = 0.0;          ///< relative strength of clouds half a metre to several metres wide
  double drift_speed_m_per_s = 0.03;
  std::vector<SiltEpisode> silt;
  std::shared_ptr<const DriftTrack> current = nullptr;  ///< carries the clouds instead of the drift
};

/// The water at one moment.
class Water {
 public:
  Water(const WaterOptions& options, double time_s, uint64_t seed);

  /// Whether attenuation is the same everywhere.
  bool uniform() const { return silt_per_m_ <= 0.0f && patchiness_ <= 0.0f; }
  /// Coefficients at a place, 1/m.
  struct Coefficients {
    float attenuation = 0.0f;
    float scattering = 0.0f;
    /// Attenuation of light in haze. Light scattered forwards continues in nearly the same direction, so only
    /// the fraction 1 - g of scattering removes it: the similarity relation (H. C. van de Hulst, "Multiple
    /// Light Scattering", 1980, chapter 14).
    float diffuse_attenuation = 0.0f;
  };
  Coefficients at(const Vec3f& point_W) const;
  Coefficients mean() const { return coefficients(clear_per_m_, silt_per_m_); }

  /// Phase function: fraction of scattered light per steradian at an angle, given its cosine. L. Henyey and
  /// J. Greenstein, "Diffuse radiation in the galaxy", Astrophysical Journal 93, 1941. In thick silt, light
  /// is scattered many times and arrives from all directions. With increasing scattering coefficient, the
  /// phase function therefore becomes isotropic, by half at 1/m (fitted by eye, not a physical law).
  float phase(float cosine, float scattering_per_m) const;

 private:
  Coefficients coefficients(float clear_per_m, float silt_per_m) const;

  float clear_per_m_, scattering_share_, asymmetry_, patchiness_;
  float silt_per_m_ = 0.0f;
  Vec3f drift_m_;
  uint32_t seed_;
};

/// Attenuation added by an episode at a time, 1/m: fast increase, slow decrease.
double siltAttenuation(const SiltEpisode& episode, double time_s);

}  // namespace lodeline

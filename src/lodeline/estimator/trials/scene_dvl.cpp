#include "lodeline/estimator/trials/scene_dvl.h"

#include <utility>

#include "lodeline/geometry/so3.h"

namespace lodeline {

SceneDvl::SceneDvl(const TestScene& scene, const DvlCalibration& dvl, const TestSceneOptions& options,
                   SceneDvlErrors errors)
    : scene_(scene),
      dvl_(dvl),
      start_(options.points.start),
      errors_(std::move(errors)),
      random_(options.seed, "dvl") {}

DvlCalibration SceneDvl::lookingDown() {
  DvlCalibration dvl;
  dvl.rate_hz = 8.0;
  dvl.velocity_noise_std_m_per_s = 0.005;
  Mat3 axes_B;  // x forward, y to the right, z down
  axes_B << 1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0;
  dvl.body_from_dvl = Rigid3(Quat(axes_B) * so3::exp(Vec3(0.1, -0.05, 0.4)), Vec3(-0.3, 0.1, -0.2));
  return dvl;
}

std::vector<DvlSample> SceneDvl::until(Time end) {
  std::vector<DvlSample> samples;
  for (;; ++next_) {
    const double time_s = (static_cast<double>(next_) + 0.37) / dvl_.rate_hz;
    if (start_ + Duration::fromSeconds(time_s) > end) return samples;
    samples.push_back(pingAt(time_s));
    if (errors_.spoil) errors_.spoil(time_s, &samples.back());
  }
}

DvlSample SceneDvl::pingAt(double time_s) {
  const MotionState truth = scene_.motion().at(time_s);
  const Vec3 current_W = errors_.current_W ? errors_.current_W(time_s) : Vec3::Zero();
  const Vec3 instrument_B = truth.world_from_body.rotation.conjugate() * (truth.velocity_W - current_W) +
                            truth.angular_velocity_B.cross(dvl_.body_from_dvl.translation);
  const Quat body_from_dvl = dvl_.body_from_dvl.rotation * so3::exp(errors_.misalignment_rad);
  const Vec3 velocity_D = (1.0 + errors_.scale) * (body_from_dvl.conjugate() * instrument_B);
  DvlSample sample;
  sample.time = start_ + Duration::fromSeconds(time_s);
  if (errors_.current_W) sample.track = DvlTrack::Water;
  if (!errors_.has_beams) {
    sample.velocity_D = velocity_D + errors_.noise_m_per_s * random_.normal3();
    return sample;
  }
  for (int i = 0; i < static_cast<int>(dvl_.beams_D.size()); ++i) {
    DvlBeam beam;
    beam.index = i;
    const double noise = errors_.noise_m_per_s * random_.normal();
    const bool is_missing = random_.chance(errors_.missing_share);
    const bool is_sentinel = random_.chance(errors_.sentinel_share);
    if (!is_missing) beam.velocity_m_per_s = dvl_.beams_D[static_cast<size_t>(i)].dot(velocity_D) + noise;
    if (is_sentinel) beam.velocity_m_per_s = random_.chance(0.5) ? -2.0 : 0.0;
    sample.beams.push_back(beam);
  }
  return sample;
}

}  // namespace lodeline

#include "simulation/motion/hand_motion.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "lodeline/util/angles.h"
#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kEnvelopeKnot_s = 0.25;

MotionChannel::Enveloped noise(const HandMotionOptions& o, const char* stream, double spacing_s,
                               double sigma) {
  return motionNoise(o.seed, stream, o.duration_s, o.activity, spacing_s, sigma / 0.65 * o.liveliness);
}

Spline strength(const HandMotionOptions& o, const TimeFunction& share, double amplitude) {
  return motionSpline(o.duration_s, kEnvelopeKnot_s,
                      [&](double t) { return o.liveliness * amplitude * share(t); });
}

// Phase of a periodic motion whose frequency varies by a tenth.
Spline phase(const HandMotionOptions& o, const char* stream, double lowest_hz, double highest_hz) {
  Random random(o.seed, stream);
  const double frequency_hz = random.uniform(lowest_hz, highest_hz);
  const double start = random.uniform(0.0, 2.0 * std::numbers::pi);
  const Waves wander(o.seed, stream, 20.0, 90.0);
  return motionSpline(o.duration_s, 0.5, [&](double t) {
    return start + 2.0 * std::numbers::pi * frequency_hz * t + 0.5 * wander(t);
  });
}

void addKicks(const HandMotionOptions& o, MotionChannels& c) {
  const Spline cycle = phase(o, "hand/kick", 0.45, 0.65);
  const auto add = [&](MotionChannel& channel, double amplitude, double multiple, double offset) {
    channel.sines.push_back({strength(o, o.kick, amplitude), cycle, multiple, offset});
  };
  add(c.forward, 0.006, 2.0, 0.0);
  add(c.forward, 0.0012, 4.0, 0.9);
  add(c.left, 0.005, 1.0, 0.4);
  add(c.above, 0.003, 2.0, 1.3);
  add(c.roll, 1.3 * kDegree, 1.0, 0.0);
  add(c.roll, 0.3 * kDegree, 3.0, 0.5);
  add(c.yaw, 0.9 * kDegree, 1.0, 1.1);
  add(c.pitch, 0.7 * kDegree, 2.0, 0.6);
}

void addBreathing(const HandMotionOptions& o, MotionChannels& c) {
  const Spline breath = phase(o, "hand/breath", 0.16, 0.22);
  c.above.sines.push_back({strength(o, o.activity, 0.025), breath, 1.0, 0.0});
  c.pitch.sines.push_back({strength(o, o.activity, 0.6 * kDegree), breath, 1.0, 1.8});
}

void addSweeps(const HandMotionOptions& o, MotionChannels& c) {
  struct Sweep {
    double middle_s, half_width_s, yaw, pitch;
  };
  std::vector<Sweep> sweeps;
  Random random(o.seed, "hand/sweeps");
  for (double t = random.uniform(3.0, 12.0); t < o.duration_s; t += random.uniform(10.0, 30.0)) {
    const double half_width_s = random.uniform(2.0, 4.0);
    const double yaw = random.sign() * random.uniform(10.0, 30.0) * kDegree;
    const double pitch = random.uniform(-12.0, 14.0) * kDegree;
    sweeps.push_back({t, half_width_s, yaw, pitch});
  }
  const auto control = [&](double Sweep::*angle) {
    return motionSpline(o.duration_s, 0.5, [&, angle](double t) {
      double sum = 0.0;
      for (const Sweep& sweep : sweeps) {
        const double u = (t - sweep.middle_s) / sweep.half_width_s;
        if (std::abs(u) < 1.0) sum += sweep.*angle * std::pow(std::cos(0.5 * std::numbers::pi * u), 2);
      }
      return o.liveliness * o.activity(t) * sum;
    });
  };
  c.yaw.splines.push_back(control(&Sweep::yaw));
  c.pitch.splines.push_back(control(&Sweep::pitch));
}

}  // namespace

Spline motionSpline(double duration_s, double spacing_s, const TimeFunction& control) {
  return Spline(-Motion::kMargin_s, duration_s + Motion::kMargin_s, spacing_s, control);
}

MotionChannel::Enveloped motionNoise(uint64_t seed, std::string_view stream, double duration_s,
                                     const TimeFunction& envelope, double spacing_s, double control_sigma) {
  Random random(seed, stream);
  return {motionSpline(duration_s, kEnvelopeKnot_s, envelope),
          motionSpline(duration_s, spacing_s, [&](double) { return control_sigma * random.normal(); })};
}

void addHandMotion(const HandMotionOptions& o, MotionChannels& c) {
  addKicks(o, c);
  addBreathing(o, c);
  if (o.sweeps) addSweeps(o, c);
  c.yaw.enveloped.push_back(noise(o, "hand/sway/yaw", 1.2, 2.5 * kDegree));
  c.pitch.enveloped.push_back(noise(o, "hand/sway/pitch", 1.2, 2.0 * kDegree));
  c.roll.enveloped.push_back(noise(o, "hand/sway/roll", 1.2, 3.0 * kDegree));
  c.left.enveloped.push_back(noise(o, "hand/sway/left", 1.5, 0.012));
  c.above.enveloped.push_back(noise(o, "hand/sway/above", 1.5, 0.010));
  c.yaw.enveloped.push_back(noise(o, "hand/tremor/yaw", 0.15, 0.08 * kDegree));
  c.pitch.enveloped.push_back(noise(o, "hand/tremor/pitch", 0.15, 0.08 * kDegree));
  c.roll.enveloped.push_back(noise(o, "hand/tremor/roll", 0.15, 0.10 * kDegree));
  c.forward.enveloped.push_back(noise(o, "hand/tremor/forward", 0.15, 0.0003));
  c.left.enveloped.push_back(noise(o, "hand/tremor/left", 0.15, 0.0004));
  c.above.enveloped.push_back(noise(o, "hand/tremor/above", 0.15, 0.0004));
}

}  // namespace lodeline

#include "simulation/rendering/cave/passage_shapes.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "simulation/rendering/cave/passage_curve.h"
#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kAround = 2.0 * std::numbers::pi;
constexpr double kStation_m = 0.25;

double sectionSize(double mean_m, double variation, double wave) {
  return mean_m * std::clamp(std::exp(variation * wave), 0.5, 1.6);
}

/// A smooth random function of an angle with unit RMS: harmonics of random phases, the longer ones larger.
class RingWaves {
 public:
  RingWaves(uint64_t seed, const char* stream, double length_m, double shortest_m, double longest_m) {
    Random random(seed, stream);
    double power = 0.0;
    for (size_t i = 0; i < harmonic_.size(); ++i) {
      const double wavelength_m =
          shortest_m * std::pow(longest_m / shortest_m, (static_cast<double>(i) + random.uniform()) / 6.0);
      harmonic_[i] = std::max(1.0, std::round(length_m / wavelength_m));
      phase_[i] = random.uniform(0.0, kAround);
      amplitude_[i] = std::sqrt(wavelength_m);
      power += 0.5 * amplitude_[i] * amplitude_[i];
    }
    for (double& amplitude : amplitude_) amplitude /= std::sqrt(power);
  }

  double operator()(double angle) const {
    double sum = 0.0;
    for (size_t i = 0; i < harmonic_.size(); ++i)
      sum += amplitude_[i] * std::sin(harmonic_[i] * angle + phase_[i]);
    return sum;
  }

 private:
  std::array<double, 6> harmonic_{}, phase_{}, amplitude_{};
};

/// Outline of a circuit: the distance from its centre and the height, as Fourier series of the angle.
struct Outline {
  std::array<double, 4> bulge{}, bulge_phase{};  ///< harmonics 2 to 5
  std::array<double, 3> rise{}, rise_phase{};    ///< harmonics 1 to 3, relative to the length
  double size_m = 1.0;

  Vec3 at(double angle) const {
    double radius = 1.0, height = 0.0;
    for (size_t k = 0; k < bulge.size(); ++k)
      radius += bulge[k] * std::cos(static_cast<double>(k + 2) * angle + bulge_phase[k]);
    for (size_t k = 0; k < rise.size(); ++k)
      height += rise[k] * std::cos(static_cast<double>(k + 1) * angle + rise_phase[k]);
    return size_m * Vec3(radius * std::cos(angle), radius * std::sin(angle), height);
  }

  double length_m() const {
    double sum = 0.0;
    for (int i = 0; i < kPieces; ++i)
      sum += (at(kAround * (i + 1) / kPieces) - at(kAround * i / kPieces)).norm();
    return sum;
  }

  /// Greatest curvature in plan, 1/m.
  double greatestCurvature() const {
    double most = 0.0;
    for (int i = 0; i < kPieces; ++i) {
      Vec3 p[3];
      for (int k = 0; k < 3; ++k) {
        p[k] = at(kAround * (i + 4 * (k - 1)) / kPieces);
        p[k].z() = 0.0;
      }
      const Vec3 a = p[1] - p[0], b = p[2] - p[1];
      most = std::max(most, a.cross(b).norm() / (a.norm() * b.norm() * 0.5 * (a.norm() + b.norm())));
    }
    return most;
  }

 private:
  static constexpr int kPieces = 1440;
};

Outline drawOutline(const CircuitOptions& o) {
  // The inner walls of a bend this tight still diverge from its centre.
  const double most_curvature = 1.0 / (1.3 * o.mean_width_m);
  if (!(std::isfinite(o.length_m) && o.length_m >= 1.15 * kAround / most_curvature)) {
    throw UsageError(
        fmt::format("a circuit of {:.0f} m is too short for a passage {:.1f} m wide; it needs {:.0f} m",
                    o.length_m, o.mean_width_m, std::ceil(1.15 * kAround / most_curvature)));
  }
  Random random(o.seed, "circuit/outline");
  Outline outline;
  constexpr std::array<double, 4> kBulge = {0.20, 0.07, 0.03, 0.015};
  constexpr std::array<double, 3> kRise = {0.13, 0.04, 0.02};
  for (size_t k = 0; k < kBulge.size(); ++k) {
    outline.bulge[k] = kBulge[k] * random.uniform(0.7, 1.3);
    outline.bulge_phase[k] = random.uniform(0.0, kAround);
  }
  for (size_t k = 0; k < kRise.size(); ++k) {
    outline.rise[k] = kRise[k] * random.uniform(0.7, 1.3);
    outline.rise_phase[k] = random.uniform(0.0, kAround);
  }
  for (int attempt = 0; attempt < 40; ++attempt) {
    outline.size_m *= o.length_m / outline.length_m();
    if (outline.greatestCurvature() <= most_curvature) break;
    for (double& bulge : outline.bulge) bulge *= 0.85;
  }
  return outline;
}

}  // namespace

Centerline makeCircuit(const CircuitOptions& o) {
  const Outline outline = drawOutline(o);
  const RingWaves width(o.seed, "circuit/width", o.length_m, 5.0, 50.0);
  const RingWaves height(o.seed, "circuit/height", o.length_m, 6.0, 40.0);
  Random random(o.seed, "circuit/start");
  const double start = random.uniform(0.0, kAround), way = random.sign();
  const auto curve = [&](double u) {
    const double angle = start + way * u;
    return PassagePoint{outline.at(angle), sectionSize(o.mean_width_m, o.section_variation, width(angle)),
                        sectionSize(o.mean_height_m, o.section_variation, height(angle))};
  };
  return evenlySpaced(curve, 0.0, kAround, 0.0, true, kStation_m);
}

Centerline makeBranch(const PassageStation& root, const BranchOptions& o) {
  const Waves winding(o.seed, "branch/winding", 18.0, 60.0),
      undulation(o.seed, "branch/undulation", 12.0, 50.0);
  const Waves width(o.seed, "branch/width", 5.0, 30.0), height(o.seed, "branch/height", 6.0, 30.0);
  // The steepest part of smoothRise() has slope 1.875.
  const double turn_m = 1.875 * o.turn_radius_m * std::abs(o.turn_rad);
  const double azimuth0 = std::atan2(root.tangent_W.y(), root.tangent_W.x());
  const double slope0 = root.tangent_W.z() / root.tangent_W.head<2>().norm();
  const auto tangentAt = [&](double s) -> Vec3 {
    const double free = smoothRise((s - 0.5 * turn_m) / turn_m);
    const double azimuth =
        azimuth0 + o.turn_rad * smoothRise(s / turn_m) + free * o.bend_rad * std::tanh(winding(s));
    const double own = o.slope + 0.1 * std::tanh(undulation(s));
    const double slope = slope0 + smoothRise(s / turn_m) * (own - slope0);
    return Vec3(std::cos(azimuth), std::sin(azimuth), slope).normalized();
  };
  const auto sectionAt = [&](double s, double root_m, double own_m) {
    // Own size beyond the fork; smaller than the other passage inside it.
    const double mixed_m = root_m + smoothRise(s / turn_m) * (own_m - root_m);
    return mixed_m * (1.0 - 0.4 * smoothRise(-s / kBranchInset_m));
  };
  const int before = static_cast<int>(std::lround(kBranchInset_m / kStation_m));
  const int after = static_cast<int>(std::ceil((o.length_m + o.run_out_m) / kStation_m));
  std::vector<PassageStation> stations;
  Vec3 position = Vec3::Zero();
  for (int i = -before; i <= after; ++i) {
    const double s = i * kStation_m;
    if (i > -before) {
      position += kStation_m / 6.0 *
                  (tangentAt(s - kStation_m) + 4.0 * tangentAt(s - 0.5 * kStation_m) + tangentAt(s));
    }
    stations.push_back({s, position, tangentAt(s),
                        sectionAt(s, root.width_m, sectionSize(o.mean_width_m, 0.25, width(s))),
                        sectionAt(s, root.height_m, sectionSize(o.mean_height_m, 0.25, height(s)))});
  }
  const Centerline line = Centerline::through(std::move(stations), false);
  return line.translated(root.position_W - line.at(0.0).position_W);
}

Room makeRoom(const RoomOptions& o) {
  constexpr double kBefore_m = 6.0, kWay_in_m = 10.0, kWall_m = 7.0, kRun_out_m = 8.0;
  const double chamber_m = 24.0 * o.scale;
  Random random(o.seed, "room/azimuth");
  const double azimuth = random.uniform(0.0, kAround);
  const Waves width(o.seed, "room/width", 6.0, 30.0), height(o.seed, "room/height", 6.0, 30.0);
  const Vec3 along(std::cos(azimuth), std::sin(azimuth), -0.03);
  const auto curve = [&](double x) {
    const double open = smoothRise((x - kWay_in_m) / (kWall_m * o.scale)) *
                        smoothRise((kWay_in_m + chamber_m - x) / (kWall_m * o.scale));
    return PassagePoint{x * along, (4.2 + (18.0 * o.scale - 4.2) * open) * (1.0 + 0.06 * std::tanh(width(x))),
                        (2.8 + (6.0 * o.scale - 2.8) * open) * (1.0 + 0.06 * std::tanh(height(x)))};
  };
  const double end = kWay_in_m + chamber_m + kRun_out_m;
  const double stretch = along.norm();
  return {evenlySpaced(curve, -kBefore_m, end, -kBefore_m * stretch, false, kStation_m), kWay_in_m * stretch,
          (kWay_in_m + chamber_m) * stretch};
}

}  // namespace lodeline

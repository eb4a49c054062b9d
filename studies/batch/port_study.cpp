// Compares the batch solution with constant ports and with ports as states, on dives of points behind ports
// that the rig file misstates. Prints the tables of docs/lab-notes/optics.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>

#include "lodeline/batch/ports/test_port_dive.h"
#include "lodeline/util/angles.h"

namespace {

using namespace lodeline;

/// Sums of squares over dives.
struct Errors {
  double position_m2 = 0.0, heading_rad2 = 0.0, end_m2 = 0.0, core_s = 0.0;

  void add(const PortDive& dive, const std::vector<FrameEstimate>& frames, double processor_s) {
    position_m2 += std::pow(dive.rms(frames), 2);
    heading_rad2 += std::pow(dive.rms(frames, true), 2);
    end_m2 += (frames.back().state.world_from_body.translation - dive.truth.back().translation).squaredNorm();
    core_s += processor_s;
  }
  void print(const char* name, int dives) const {
    fmt::print("{:22} position {:7.2f} cm  heading {:6.3f} deg  end {:7.2f} cm  {:6.1f} core-s\n", name,
               100.0 * std::sqrt(position_m2 / dives), kDegreesPerRadian * std::sqrt(heading_rad2 / dives),
               100.0 * std::sqrt(end_m2 / dives), core_s / dives);
  }
};

/// Errors of the ports: the first two numbers and the third one of each, before and after.
struct PortErrors {
  std::array<double, 2> file = {}, found = {}, claimed = {};
  int ports = 0, beyond_3_sigma = 0;

  void add(const PortDive& dive, const CameraCorrections& corrections) {
    for (size_t i = 0; i < corrections.ports.size(); ++i) {
      const PortCorrection& port = corrections.ports[i];
      const Vec3 left = port.change - dive.true_changes[i];
      const auto addTo = [](std::array<double, 2>& to, const Vec3& of) {
        to[0] += of.head<2>().squaredNorm();
        to[1] += of.z() * of.z();
      };
      addTo(file, dive.true_changes[i]);
      addTo(found, left);
      addTo(claimed, port.sigma);
      ++ports;
      beyond_3_sigma += static_cast<int>((left.array().abs() > 3.0 * port.sigma.array()).count());
    }
  }
  void print(bool is_dome) const {
    if (ports == 0) return;
    const double unit = is_dome ? 1e3 : kDegreesPerRadian;
    const auto rms = [&](double squares) { return std::sqrt(squares / ports); };
    fmt::print(
        "{}: file {:.3f}, found {:.3f}, claimed {:.3f}; {}: file {:.2f}, found {:.2f}, claimed {:.2f}; "
        "beyond 3 sigma {} of {}\n",
        is_dome ? "centre x, y mm" : "normal deg", unit * rms(file[0]), unit * rms(found[0]),
        unit * rms(claimed[0]), is_dome ? "z mm" : "distance mm", 1e3 * rms(file[1]), 1e3 * rms(found[1]),
        1e3 * rms(claimed[1]), beyond_3_sigma, 3 * ports);
  }
};

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Batch solutions of dives behind misstated ports, with the ports constant and as states.");
  PortDiveOptions dive;
  dive.seconds = 300.0;
  dive.metres = 90.0;
  int seeds = 3;
  uint64_t first_seed = 1;
  double wrong = 1.0;
  bool dome = false, lens_off = false;
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--cameras", dive.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--seconds", dive.seconds)->capture_default_str();
  app.add_option("--metres", dive.metres)->capture_default_str();
  app.add_option("--wrong", wrong, "errors of the ports, times 0.5 degrees and 3 mm")->capture_default_str();
  app.add_flag("--dome", dome);
  app.add_flag("--lens-off", lens_off, "lenses of the files off by 0.1 % and 1 px (one sigma)");
  CLI11_PARSE(app, argc, argv);
  dive.normal_error_rad *= wrong;
  dive.length_error_m *= wrong;
  if (dome) dive.type = Port::Type::Dome;
  if (lens_off) {
    dive.focal_error = 0.001;
    dive.centre_error_px = 1.0;
  }
  Errors window, constant, states;
  PortErrors ports;
  for (int i = 0; i < seeds; ++i) {
    dive.seed = first_seed + static_cast<uint64_t>(i);
    const PortDive run(dive, {});
    EstimatorOptions held = run.options;
    held.camera_calibration.port_normal_sigma_rad = held.camera_calibration.port_distance_sigma_m = 0.0;
    const Refinement with_constant = refine(run.given, held, run.record);
    const Refinement with_states = refine(run.given, run.options, run.record);
    for (const Refinement* refined : {&with_constant, &with_states}) {
      if (!refined->summary.usable())
        fmt::print("seed {}: refused, {}\n", dive.seed, refined->summary.refusal);
    }
    window.add(run, run.record.frames(), 0.0);
    constant.add(run, with_constant.frames, with_constant.summary.processor_s);
    states.add(run, with_states.frames, with_states.summary.processor_s);
    if (with_states.summary.camera_corrections) ports.add(run, *with_states.summary.camera_corrections);
  }
  window.print("window", seeds);
  constant.print("batch, constant ports", seeds);
  states.print("batch, ports as states", seeds);
  ports.print(dome);
  return 0;
}

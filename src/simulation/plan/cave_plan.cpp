#include "simulation/plan/cave_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "simulation/rendering/cave/passage_curve.h"
#include "simulation/rendering/cave/passage_shapes.h"

namespace lodeline {
namespace {

PassagePoint pointAt(const Centerline& line, double arc_length_m) {
  const PassageStation station = line.at(arc_length_m);
  return {station.position_W, station.width_m, station.height_m};
}

/// `first` up to its arc length `at_m`, then `second` from its arc length 0 on, to `end_m` of the whole.
Centerline joined(const Centerline& first, double at_m, const Centerline& second, double end_m) {
  const auto curve = [&](double s) { return s < at_m ? pointAt(first, s) : pointAt(second, s - at_m); };
  return evenlySpaced(curve, first.beginArcLength(), end_m, first.beginArcLength(), false);
}

void require(bool possible, const char* shape, double path_m, double least_m, double most_m) {
  if (possible) return;
  throw UsageError(
      fmt::format("a {} needs --metres between {:.0f} and {:.0f}, got {:g}", shape, least_m, most_m, path_m));
}

CavePlan planPassage(const CavePlanOptions& o) {
  const CenterlineOptions options = passageOptions(o);
  const double penetration_m = 0.5 * o.path_length_m;
  if (penetration_m > options.length_m * (1.0 + 1e-9)) {
    throw UsageError(fmt::format("{:g} m in and back do not fit into a cave of {:g} m", o.path_length_m,
                                 options.length_m));
  }
  const Centerline passage = Centerline::generate(options);
  const Centerline track = o.entrance == 2 ? passage.reversed(options.length_m) : passage;
  return {{{passage}}, straightRoute(track, penetration_m, true), {{0, 0.0, options.length_m}}};
}

CavePlan planLoop(const CavePlanOptions& o) {
  constexpr double kWayIn_m = 14.0, kOverlap = 0.1;
  CircuitOptions circuit;
  circuit.seed = o.seed;
  circuit.length_m = o.path_length_m / o.laps;
  if (o.decorated) circuit.mean_width_m = 5.0;
  const Centerline ring = makeCircuit(circuit);
  // Backwards from the ring, and away from its middle.
  PassageStation root = ring.at(0.0);
  const Vec3 inwards_W = ring.at(4.0).tangent_W - root.tangent_W;
  root.tangent_W = -root.tangent_W;
  BranchOptions branch;
  branch.seed = o.seed;
  branch.length_m = kWayIn_m;
  branch.slope = 0.1;
  branch.turn_rad = std::copysign(0.9, -root.tangent_W.cross(inwards_W).z());
  const Centerline way_in = makeBranch(root, branch).reversed(kWayIn_m);
  const double end_m = kWayIn_m + (o.laps + kOverlap) * ring.length_m();
  return {{{ring, way_in}},
          {{joined(way_in, kWayIn_m, ring, end_m)}, {{0, 0.0, end_m}}},
          {{1, 0.0, kWayIn_m}, {0, 0.0, ring.length_m()}}};
}

CavePlan planJunction(const CavePlanOptions& o) {
  require(o.path_length_m >= 100.0 && o.path_length_m <= 600.0, "junction", o.path_length_m, 100.0, 600.0);
  const double main_m = 0.32 * o.path_length_m, fork_m = 0.35 * main_m, branch_m = 0.18 * o.path_length_m;
  CenterlineOptions main = passageOptions(o);
  main.length_m = main_m;
  main.descent_m = 0.06 * main_m;
  main.bend_rad = 0.3;
  const Centerline passage = Centerline::generate(main);
  const PassageStation root = passage.at(fork_m);
  // To the side from which the main passage bends away in the mean.
  const Vec3 onward_W = passage.at(main_m).position_W - root.position_W;
  BranchOptions options;
  options.seed = o.seed;
  options.length_m = branch_m;
  options.slope = 0.05;
  options.turn_rad = std::copysign(1.3, -root.tangent_W.cross(onward_W).z());
  const Centerline branch = makeBranch(root, options);
  const double end_m = fork_m + branch_m;
  const Centerline aside = joined(passage, fork_m, branch, end_m + options.run_out_m);
  return {{{passage, branch}},
          {{aside, passage}, {{0, 0.0, end_m}, {0, end_m, fork_m}, {1, fork_m, main_m}, {1, main_m, 0.0}}},
          {{0, 0.0, main_m}, {1, 0.0, branch_m}}};
}

/// Rounds through a chamber: from its middle line to one side, then around, with radii between wide and
/// narrow, and heights below and above the middle.
CavePlan planRoom(const CavePlanOptions& o) {
  // Lengths for scale 1: a round, and the way from the chamber's begin to its middle and to the end.
  constexpr double kWayIn_m = 10.0, kRound_m = 28.5, kRest_m = 14.5;
  const double scaled_m = kRound_m * o.laps + kRest_m;
  const double scale = (o.path_length_m - kWayIn_m) / scaled_m;
  require(scale >= 0.8 && scale <= 1.8, "room", o.path_length_m, std::ceil(kWayIn_m + 0.8 * scaled_m),
          std::floor(kWayIn_m + 1.8 * scaled_m));
  const Room room = makeRoom({o.seed, scale});
  const double middle_m = 0.5 * (room.begin_m + room.end_m), enter_m = room.begin_m - 4.0;
  const PassageStation middle = room.passage.at(middle_m);
  const Vec3 along_W = middle.tangent_W, left_W = Vec3::UnitZ().cross(along_W).normalized();
  const double turns = 2.0 * std::numbers::pi * o.laps + 0.6;
  constexpr double kWide_m = 3.3, kNarrow_m = 2.4, kLong_m = 6.0, kRise_m = 0.45;
  const auto curve = [&](double u) {
    const PassageStation here = room.passage.at(std::min(u, middle_m));
    const double inside = smoothRise((u - enter_m) / (middle_m - enter_m));
    PassagePoint point{here.position_W, 0.0, 0.0};
    point.width_m = 4.2 + (3.0 - 4.2) * inside;
    point.height_m = 2.8 + (1.8 - 2.8) * inside;
    const double angle = std::max(0.0, u - middle_m) / (kLong_m * scale);
    const double swing = 0.5 - 0.5 * std::cos(0.5 * angle);
    const double across_m = scale * (kWide_m + (kNarrow_m - kWide_m) * swing);
    point.position_W += kLong_m * scale * std::sin(angle) * along_W -
                        inside * across_m * std::cos(angle) * left_W +
                        inside * scale * kRise_m * (2.0 * swing - 1.0) * Vec3::UnitZ();
    return point;
  };
  const Centerline track =
      evenlySpaced(curve, room.passage.beginArcLength(), middle_m + kLong_m * scale * turns,
                   room.passage.beginArcLength(), false);
  return {{{room.passage}}, {{track}, {{0, 0.0, track.endArcLength()}}}, {{0, 0.0, room.end_m}}};
}

}  // namespace

CenterlineOptions passageOptions(const CavePlanOptions& o) {
  CenterlineOptions options;
  options.seed = o.seed;
  options.length_m = o.cave_length_m.value_or(0.5 * o.path_length_m);
  options.descent_m = std::min(0.08 * options.length_m, o.decorated ? 6.0 : 20.0);
  if (o.decorated) {
    // Dissolved along joints near the water table: horizontal, wide and low passages.
    options.mean_width_m = 5.5;
    options.mean_height_m = 2.6;
    options.undulation_m = 0.5;
    options.shortest_bend_m = 18.0;
  }
  return options;
}

CavePlan planCave(const CavePlanOptions& o) {
  if (o.laps < 1 || o.laps > 20) throw UsageError(fmt::format("--laps must be 1 to 20, got {}", o.laps));
  if (o.entrance < 1 || o.entrance > 2)
    throw UsageError(fmt::format("--entrance must be 1 or 2, got {}", o.entrance));
  CavePlan plan = o.shape == CaveShape::Loop       ? planLoop(o)
                  : o.shape == CaveShape::Junction ? planJunction(o)
                  : o.shape == CaveShape::Room     ? planRoom(o)
                                                   : planPassage(o);
  if (o.shape == CaveShape::Passage) return plan;
  // The passage with the entrance alone decides, so that the frame does not depend on the laps.
  const Vec3 start_C = plan.cave.passages[static_cast<size_t>(plan.line.front().passage)].at(0.0).position_W;
  return {plan.cave.translated(-start_C), plan.route.translated(-start_C), plan.line};
}

Motion makePlannedMotion(const CavePlan& plan, const CavePlanOptions& cave, const DiveMotionOptions& o,
                         const Rigid3& diver_from_body) {
  if (cave.shape != CaveShape::Passage) return makeRouteMotion(plan.route, o, diver_from_body);
  DiveMotionOptions options = o;
  options.path_length_m = cave.path_length_m;
  options.round_trip = true;
  return makeDiveMotion(plan.route.tracks.front(), options, diver_from_body);
}

}  // namespace lodeline

#include "simulation/dive/dive.h"

#include <cmath>
#include <utility>

#include "simulation/dive/dive_life.h"
#include "simulation/dive/vehicle_dive.h"
#include "simulation/motion/board_motion.h"
#include "simulation/motion/dive_motion.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

CavePlanOptions caveOptions(const Scenario& s) {
  CavePlanOptions options;
  options.shape = s.shape;
  options.seed = s.cave_seed.value_or(s.seed);
  options.path_length_m = s.path_length_m;
  options.cave_length_m = s.cave_length_m;
  options.laps = s.laps;
  options.entrance = s.entrance;
  options.decorated = s.decorated;
  return options;
}

DiveMotionOptions diveOptions(const Scenario& s) {
  DiveMotionOptions options;
  options.seed = s.seed;
  options.duration_s = s.duration_s;
  options.path_length_m = s.path_length_m;
  options.starts_at_rest = s.starts_at_rest;
  // Short recordings spend less time resting and turning.
  options.start_rest_s = std::min(4.0, 0.06 * s.duration_s);
  options.turn_s = std::min(10.0, 0.2 * s.duration_s);
  return options;
}

struct Place {
  std::optional<Centerline> passage;
  std::optional<FramedCave> cave;
  std::optional<WreckLayout> wreck;
  std::optional<SeaFloorOptions> sea_floor;
  std::optional<PlacedBoard> board;
};

// 6 x 6 tags on a panel of A2. The smallest tags have 25 px in images of 640 px.
PlacedBoard boardAt(const BoardPlace& place) {
  PlacedBoard placed;
  placed.board = {.columns = 6, .rows = 6, .tag_size_m = 0.055, .spacing = 0.3};
  const Vec3 centre_T(0.5 * placed.board.width_m(), 0.5 * placed.board.height_m(), 0.0);
  placed.world_from_board =
      Rigid3(place.world_from_board, place.centre_W - place.world_from_board * centre_T);
  return placed;
}

// A dive in a cave with a frame.
Motion makeCaveMotion(const Scenario& s, const Rigid3& diver_from_body, Place& place) {
  const CavePlanOptions options = caveOptions(s);
  const CavePlan plan = planCave(options);
  Motion motion = makePlannedMotion(plan, options, diveOptions(s), diver_from_body);
  const Vec3 origin_W = motion.worldShift();
  place.passage = plan.route.tracks.front().translated(origin_W);
  place.cave = FramedCave{plan.cave, placeTags(plan.cave, plan.line, s.tags, options.seed), origin_W};
  return motion;
}

Motion makeMotion(const Scenario& s, const Rigid3& diver_from_body, Place& place) {
  switch (s.motion) {
    case MotionKind::Dive: {
      if (s.cave_seed) return makeCaveMotion(s, diver_from_body, place);
      const Centerline passage = Centerline::generate(passageOptions(caveOptions(s)));
      Motion motion = makeDiveMotion(passage, diveOptions(s), diver_from_body);
      place.passage = passage.translated(motion.worldShift());
      return motion;
    }
    case MotionKind::AroundWreck: {
      Motion motion =
          makeWreckMotion({}, s.seed, s.duration_s, s.path_length_m, s.starts_at_rest, diver_from_body);
      place.wreck = WreckLayout{}.translated(motion.worldShift());
      return motion;
    }
    case MotionKind::BeforeBoard: {
      BoardPlace board;
      Motion motion = makeBoardMotion(s.seed, s.duration_s, diver_from_body, &board);
      place.board = boardAt(board);
      return motion;
    }
    case MotionKind::FigureEight:
      return makeFigureEightMotion(s.seed, s.duration_s, diver_from_body);
    case MotionKind::Transects: {
      place.sea_floor.emplace();
      return makeTransects(s, diver_from_body, &*place.sea_floor);
    }
    case MotionKind::ThroughWreck: {
      place.wreck = steelWreck();
      return makeWreckLaps(s, diver_from_body, &*place.wreck);
    }
    case MotionKind::AtRest:
    case MotionKind::CurrentRamps:
      break;
  }
  return makeMotionAtRest(s.seed, s.duration_s, diver_from_body);
}

// Random points on the faces of the box around a hull.
LandmarkField hullLandmarks(const WreckLayout& wreck, double points_per_metre, uint64_t seed) {
  Random random(seed, "landmarks");
  const Quat heading(Eigen::AngleAxisd(wreck.azimuth_rad, Vec3::UnitZ()));
  const Vec3 half(0.5 * wreck.length_m, 0.5 * wreck.width_m, 0.5 * wreck.height_m);
  std::vector<LandmarkPoint> points;
  const int count = static_cast<int>(points_per_metre * 2.0 * (wreck.length_m + wreck.width_m));
  for (int i = 0; i < count; ++i) {
    // The sides, ends and deck get points by their areas.
    const double side = half.x() * half.z(), end = half.y() * half.z(), deck = half.x() * half.y();
    const double pick = random.uniform(0.0, 2.0 * side + 2.0 * end + deck);
    Vec3 normal = Vec3::UnitZ();
    if (pick < 2.0 * side) {
      normal = (pick < side ? 1.0 : -1.0) * Vec3::UnitY();
    } else if (pick < 2.0 * side + 2.0 * end) {
      normal = (pick < 2.0 * side + end ? 1.0 : -1.0) * Vec3::UnitX();
    }
    const double u = random.uniform(-1.0, 1.0);
    const double v = random.uniform(-1.0, 1.0);
    const double relief_m = 0.15 * random.normal();
    Vec3 local = half.cwiseProduct(normal) + relief_m * normal;
    const int a = normal.x() != 0.0 ? 1 : 0;
    const int b = normal.z() != 0.0 ? 1 : 2;
    local[a] = u * half[a];
    local[b] = v * half[b];
    points.push_back({wreck.center_W + heading * (local + Vec3(0, 0, half.z())), heading * normal});
  }
  return LandmarkField(std::move(points));
}

}  // namespace

Dive makeDive(const Scenario& s) {
  Place place;
  const DiveErrors errors = drawErrors(s);
  Motion motion = makeMotion(s, errors.truth.diver_from_body, place);
  Dive dive{.scenario = s,
            .errors = errors,
            .motion = std::move(motion),
            .passage = place.passage,
            .cave = place.cave,
            .wreck = place.wreck,
            .sea_floor = place.sea_floor,
            .board = place.board,
            .disturbances = {},
            .thrust = nullptr,
            .loads = {},
            .current = nullptr,
            .fish = {},
            .buddy = nullptr,
            .halocline = {},
            .start = {}};
  dive.field_W = scenarioField(s);
  dive.surface_height_m = s.start_depth_m;
  // The water has one surface for all dives of a cave.
  if (dive.cave) dive.surface_height_m += dive.cave->origin_W.z();
  // 2026-11-21, 10:00 UTC, for every date of the scenario. Only the year of that date is used, for the
  // magnetic field.
  dive.start = Time::fromNanoseconds(1'795'255'200'000'000'000);
  // Dives of one cave are on different days.
  if (s.cave_seed)
    dive.start = dive.start + Duration::fromSeconds(86400.0 * static_cast<double>(s.seed % 1000));
  if (s.motion == MotionKind::Dive || s.motion == MotionKind::AroundWreck ||
      s.motion == MotionKind::Transects || s.motion == MotionKind::ThroughWreck) {
    DisturbanceOptions options;
    options.seed = s.seed;
    if (s.effects.has(Effect::MagneticDisturbances)) {
      dive.disturbances = drawDisturbances(dive.motion, dive.field_W, options);
    }
    // The lamps of a vehicle are among its measured currents.
    if (s.effects.has(Effect::LampCurrent) && !s.vehicle)
      dive.disturbances.switched = drawLampSwitching(s.duration_s, s.seed);
    addLife(dive);
  }
  if (s.vehicle) equipVehicle(dive);
  return dive;
}

LandmarkField diveLandmarks(const Dive& dive, double points_per_metre) {
  if (dive.scenario.vehicle) return vehicleLandmarks(dive, vehicleWorld(dive));
  if (dive.cave) {
    return caveLandmarks(dive.cave->layout.translated(dive.cave->origin_W), points_per_metre,
                         *dive.scenario.cave_seed);
  }
  if (dive.passage) return passageLandmarks(*dive.passage, points_per_metre, dive.scenario.seed);
  if (dive.wreck) return hullLandmarks(*dive.wreck, points_per_metre, dive.scenario.seed);
  return LandmarkField({});
}

}  // namespace lodeline

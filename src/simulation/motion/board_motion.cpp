#include "simulation/motion/board_motion.h"

#include <cmath>
#include <numbers>

#include "lodeline/util/angles.h"
#include "simulation/motion/hand_motion.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

/// Sum of two sines with incommensurate periods and random phases, within -1 and 1.
class Swing {
 public:
  Swing(double slow_period_s, double fast_period_s, Random& random)
      : slow_(2.0 * std::numbers::pi / slow_period_s),
        fast_(2.0 * std::numbers::pi / fast_period_s),
        slow_phase_(random.uniform(0.0, 2.0 * std::numbers::pi)),
        fast_phase_(random.uniform(0.0, 2.0 * std::numbers::pi)) {}

  double operator()(double t) const {
    return 0.72 * std::sin(slow_ * t + slow_phase_) + 0.28 * std::sin(fast_ * t + fast_phase_);
  }

 private:
  double slow_, fast_, slow_phase_, fast_phase_;
};

}  // namespace

Motion makeBoardMotion(uint64_t seed, double duration_s, const Rigid3& diver_from_body, BoardPlace* board) {
  constexpr double kKnot_s = 0.1;
  Random random(seed, "board/motion");
  const Swing distance(9.1, 2.3, random), side(5.3, 1.7, random), rise(6.7, 1.9, random);
  const Swing yaw(4.1, 1.3, random), pitch(4.7, 1.5, random), roll(7.3, 1.6, random);
  // The board hangs at the origin of the channels and faces west; the rig looks east.
  const auto position = [&](double t) {
    return Vec3(-0.68 - 0.2 * distance(t), 0.34 * side(t), 0.26 * rise(t));
  };
  const auto spline = [&](const auto& of) {
    MotionChannel channel;
    channel.splines.push_back(motionSpline(duration_s, kKnot_s, of));
    return channel;
  };
  MotionChannels c;
  c.east = spline([&](double t) { return position(t).x(); });
  c.north = spline([&](double t) { return position(t).y(); });
  c.up = spline([&](double t) { return position(t).z(); });
  c.yaw = spline(
      [&](double t) { return std::atan2(-position(t).y(), -position(t).x()) + 17.0 * kDegree * yaw(t); });
  c.pitch = spline(
      [&](double t) { return std::atan2(position(t).z(), -position(t).x()) + 14.0 * kDegree * pitch(t); });
  c.roll = spline([&](double t) { return 38.0 * kDegree * roll(t); });
  HandMotionOptions hand;
  hand.seed = seed;
  hand.duration_s = duration_s;
  hand.sweeps = false;
  hand.kick = [](double) { return 0.0; };
  hand.activity = [](double) { return 1.0; };
  addHandMotion(hand, c);
  Motion motion(std::move(c), diver_from_body, duration_s);
  Mat3 world_from_board;
  // x of the board to the right of the viewer (south), y up, z towards the viewer (west).
  world_from_board << 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
  // Nobody hangs a board exactly upright.
  const Quat tilt(Eigen::AngleAxisd(random.uniform(-3.0, 3.0) * kDegree, random.direction()));
  *board = {motion.worldShift(), Quat(world_from_board) * tilt};
  return motion;
}

}  // namespace lodeline

#include "lodeline/rig_calibration/start/inertial_start.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/io/synchronizer/imu_interval.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kLongestTurn_s = 0.35;  // between frames whose rates are compared

/// Integral of the angular velocity since the first reading, for means over any interval.
class RateIntegral {
 public:
  explicit RateIntegral(std::span<const ImuSample> imu) : imu_(imu) {
    sums_.push_back(Vec3::Zero());
    for (size_t i = 1; i < imu.size(); ++i) {
      const double step_s = (imu[i].time - imu[i - 1].time).seconds();
      sums_.push_back(sums_.back() +
                      0.5 * step_s * (imu[i].angular_velocity_B + imu[i - 1].angular_velocity_B));
    }
  }

  std::optional<Vec3> at(Time time) const {
    const auto next = std::lower_bound(imu_.begin(), imu_.end(), time,
                                       [](const ImuSample& sample, Time t) { return sample.time < t; });
    if (next == imu_.end() || next == imu_.begin()) return std::nullopt;
    const size_t i = static_cast<size_t>(next - imu_.begin()) - 1;
    const ImuSample here = interpolate(imu_[i], imu_[i + 1], time);
    const double step_s = (time - imu_[i].time).seconds();
    return Vec3(sums_[i] + 0.5 * step_s * (imu_[i].angular_velocity_B + here.angular_velocity_B));
  }

 private:
  std::span<const ImuSample> imu_;
  std::vector<Vec3> sums_;
};

/// A turn between two frames, in axes of the first camera.
struct Turn {
  Time begin, end;
  Vec3 rate_C;
};

std::vector<Turn> turnsBetweenFrames(const RigState& state) {
  std::vector<Turn> turns;
  for (size_t f = 1; f < state.frames.size(); ++f) {
    const FrameState &a = state.frames[f - 1], &b = state.frames[f];
    const double step_s = (b.seen->stamp - a.seen->stamp).seconds();
    if (step_s > kLongestTurn_s) continue;
    const Quat turn = poseFromBlock(a.world_from_body.data()).rotation.conjugate() *
                      poseFromBlock(b.world_from_body.data()).rotation;
    turns.push_back({a.seen->stamp, b.seen->stamp, so3::log(turn) / step_s});
  }
  return turns;
}

/// The rotation and bias for one delay.
struct RateFit {
  double error = INFINITY;  ///< mean square, (rad/s)^2
  size_t turns = 0;
  Quat body_from_camera = Quat::Identity();
  Vec3 bias_B = Vec3::Zero();
};

RateFit fitRates(const std::vector<Turn>& turns, const RateIntegral& integral, double delay_s) {
  std::vector<Vec3> camera, gyroscope;
  for (const Turn& turn : turns) {
    const Duration delay = Duration::fromSeconds(delay_s);
    const auto from = integral.at(turn.begin + delay), to = integral.at(turn.end + delay);
    if (!from || !to) continue;
    camera.push_back(turn.rate_C);
    gyroscope.push_back((*to - *from) / (turn.end - turn.begin).seconds());
  }
  RateFit fit;
  fit.turns = camera.size();
  if (fit.turns < 8) return fit;
  Vec3 mean_C = Vec3::Zero(), mean_B = Vec3::Zero();
  for (size_t i = 0; i < camera.size(); ++i) {
    mean_C += camera[i] / static_cast<double>(camera.size());
    mean_B += gyroscope[i] / static_cast<double>(camera.size());
  }
  Mat3 products = Mat3::Zero();
  for (size_t i = 0; i < camera.size(); ++i)
    products += (gyroscope[i] - mean_B) * (camera[i] - mean_C).transpose();
  const Eigen::JacobiSVD<Mat3> svd(products, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  signs.z() = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  const Mat3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  fit.body_from_camera = Quat(rotation);
  fit.bias_B = mean_B - rotation * mean_C;
  // The median of the squares: single frames may have a wrong pose.
  std::vector<double> squares;
  for (size_t i = 0; i < camera.size(); ++i)
    squares.push_back((gyroscope[i] - fit.bias_B - rotation * camera[i]).squaredNorm());
  fit.error = median(std::move(squares));
  return fit;
}

double leastRate(const std::vector<Turn>& turns) {
  Vec3 mean = Vec3::Zero();
  for (const Turn& turn : turns) mean += turn.rate_C / static_cast<double>(turns.size());
  Mat3 covariance = Mat3::Zero();
  for (const Turn& turn : turns)
    covariance += (turn.rate_C - mean) * (turn.rate_C - mean).transpose() / static_cast<double>(turns.size());
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Mat3>(covariance).eigenvalues()[0]));
}

/// Mean direction of gravity in the board frame: over a long motion the accelerations cancel.
Vec3 gravityInBoard(const RigState& state, const Quat& body_from_camera, std::span<const ImuSample> imu) {
  Vec3 sum = Vec3::Zero();
  for (const FrameState& frame : state.frames) {
    const auto reading = readingAt(imu, state.timeOf(frame));
    if (!reading) continue;
    const Quat board_from_camera = poseFromBlock(frame.world_from_body.data()).rotation;
    sum -= board_from_camera * (body_from_camera.conjugate() * reading->specific_force_B);
  }
  return sum.normalized();
}

void setVelocities(RigState* state) {
  const size_t count = state->frames.size();
  for (size_t f = 0; f < count && count > 1; ++f) {
    const FrameState &before = state->frames[f > 0 ? f - 1 : 0],
                     &after = state->frames[std::min(f + 1, count - 1)];
    const double span_s = (after.seen->stamp - before.seen->stamp).seconds();
    Eigen::Map<Vec3>(state->frames[f].motion.data()) =
        (Vec3(after.world_from_body.data()) - Vec3(before.world_from_body.data())) / span_s;
  }
}

}  // namespace

std::optional<ImuSample> readingAt(std::span<const ImuSample> imu, Time time) {
  const auto next = std::lower_bound(imu.begin(), imu.end(), time,
                                     [](const ImuSample& sample, Time t) { return sample.time < t; });
  if (next == imu.end() || (next == imu.begin() && next->time != time)) return std::nullopt;
  return next->time == time ? *next : interpolate(*(next - 1), *next, time);
}

std::vector<ImuSample> readingsBetween(std::span<const ImuSample> imu, Time from, Time to,
                                       double longest_gap_s) {
  const auto first = readingAt(imu, from), last = readingAt(imu, to);
  if (!first || !last || from >= to) return {};
  std::vector<ImuSample> readings = {*first};
  auto next = std::upper_bound(imu.begin(), imu.end(), from,
                               [](Time t, const ImuSample& sample) { return t < sample.time; });
  for (; next != imu.end() && next->time < to; ++next) readings.push_back(*next);
  readings.push_back(*last);
  for (size_t i = 1; i < readings.size(); ++i) {
    if ((readings[i].time - readings[i - 1].time).seconds() > longest_gap_s) return {};
  }
  return readings;
}

InertialStart alignRates(const RigState& cameras, std::span<const ImuSample> imu, double most_delay_s) {
  const std::vector<Turn> turns = turnsBetweenFrames(cameras);
  const RateIntegral integral(imu);
  RateFit best;
  InertialStart start;
  const auto search = [&](double from_s, double to_s, double step_s) {
    for (double delay_s = from_s; delay_s <= to_s; delay_s += step_s) {
      const RateFit fit = fitRates(turns, integral, delay_s);
      if (2 * fit.turns < turns.size() || !(fit.error < best.error)) continue;
      best = fit;
      start.delay_s = delay_s;
    }
  };
  search(-most_delay_s, most_delay_s, 0.004);
  if (!std::isfinite(best.error)) {
    throw EstimationError(
        "the board is in too few successive images, or these are outside of the inertial readings, to "
        "compare "
        "the turns of camera and gyroscope; keep the board in view while the rig moves, or calibrate the "
        "cameras alone with --no-imu");
  }
  const double coarse_s = start.delay_s;
  search(coarse_s - 0.004, coarse_s + 0.004, 0.0005);
  start.body_from_camera = best.body_from_camera;
  start.gyroscope_bias_B = best.bias_B;
  start.rate_error_rad_per_s = std::sqrt(best.error);
  start.least_rate_rad_per_s = leastRate(turns);
  return start;
}

void enterInertialFrame(const InertialStart& start, std::span<const ImuSample> imu, RigState* state) {
  state->delay_s = start.delay_s;
  const Rigid3 body_from_first(start.body_from_camera, Vec3::Zero());
  const Vec3 gravity_T = gravityInBoard(*state, start.body_from_camera, imu);
  state->level_from_board = Quat::FromTwoVectors(gravity_T, -Vec3::UnitZ());
  const Rigid3 world_from_board(state->level_from_board, Vec3::Zero());
  for (CameraState& camera : state->cameras) {
    poseToBlock(body_from_first * poseFromBlock(camera.body_from_camera.data()),
                camera.body_from_camera.data());
  }
  for (FrameState& frame : state->frames) {
    const Rigid3 board_from_first = poseFromBlock(frame.world_from_body.data());
    poseToBlock(world_from_board * board_from_first * body_from_first.inverse(),
                frame.world_from_body.data());
  }
  setVelocities(state);
  for (FrameState& frame : state->frames) {
    Eigen::Map<Vec3>(frame.motion.data() + 3) = start.gyroscope_bias_B;
    Eigen::Map<Vec3>(frame.motion.data() + 6).setZero();
  }
}

InertialLinks linkFrames(std::span<const ImuSample> imu, const ImuCalibration& calibration,
                         double noise_inflation, RigState* state) {
  constexpr double kLongestGap_s = 0.05, kLongestLink_s = 1.5;
  std::erase_if(state->frames, [&](FrameState& frame) {
    const auto reading = readingAt(imu, state->timeOf(frame));
    if (reading) frame.gyroscope_reading_B = reading->angular_velocity_B;
    return !reading;
  });
  PreintegrationOptions options;
  options.noise_inflation = noise_inflation;
  // A board is before the rig for a short time. The solution measures what the noise does not explain.
  options.motion_noise = {0.03, 0.0, 0.3};
  InertialLinks links;
  for (size_t f = 0; f + 1 < state->frames.size(); ++f) {
    const FrameState& frame = state->frames[f];
    const Time from = state->timeOf(frame), to = state->timeOf(state->frames[f + 1]);
    const std::vector<ImuSample> readings = readingsBetween(imu, from, to, kLongestGap_s);
    if (readings.size() < 3 || (to - from).seconds() > kLongestLink_s) {
      links.push_back(nullptr);
      continue;
    }
    links.push_back(std::make_unique<Preintegration>(readings, Vec3(frame.motion.data() + 3),
                                                     Vec3(frame.motion.data() + 6), calibration, options));
  }
  return links;
}

}  // namespace lodeline

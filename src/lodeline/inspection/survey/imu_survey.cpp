#include "lodeline/inspection/survey/imu_survey.h"

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/io/streams/inertial_screen.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kImuGapPeriods = 4.0;
constexpr double kStandardGravity_m_per_s2 = 9.80665;
/// Length of a block of readings, at rest or for the rotation of gravity.
constexpr double kBlock_s = 0.25;

/// Mean readings over a short time.
struct Block {
  Vec3 rate = Vec3::Zero(), force = Vec3::Zero();
  double rate_deviation = 0.0, force_deviation = 0.0;
  double begin_s = 0.0, length_s = 0.0;
};

bool isSame(const ImuSample& a, const ImuSample& b) {
  return a.angular_velocity_B == b.angular_velocity_B && a.specific_force_B == b.specific_force_B;
}

std::vector<Block> blocksOf(const std::vector<ImuSample>& samples) {
  std::vector<Block> blocks;
  for (size_t begin = 0; begin < samples.size();) {
    size_t end = begin;
    Block block;
    while (end < samples.size() && (samples[end].time - samples[begin].time).seconds() < kBlock_s) {
      block.rate += samples[end].angular_velocity_B;
      block.force += samples[end].specific_force_B;
      ++end;
    }
    const auto count = static_cast<double>(end - begin);
    block.rate /= count;
    block.force /= count;
    for (size_t i = begin; i < end; ++i) {
      block.rate_deviation += (samples[i].angular_velocity_B - block.rate).squaredNorm() / (3.0 * count);
      block.force_deviation += (samples[i].specific_force_B - block.force).squaredNorm() / (3.0 * count);
    }
    block.rate_deviation = std::sqrt(block.rate_deviation);
    block.force_deviation = std::sqrt(block.force_deviation);
    block.begin_s = (samples[begin].time - samples.front().time).seconds();
    block.length_s = (samples[end - 1].time - samples[begin].time).seconds();
    if (count >= 5) blocks.push_back(block);
    begin = end;
  }
  return blocks;
}

TriadSurvey surveyTriad(const std::vector<ImuSample>& samples, Vec3 ImuSample::*reading) {
  TriadSurvey survey;
  Vec3 mean = Vec3::Zero(), square = Vec3::Zero();
  Vec3 least = samples.front().*reading, greatest = least;
  for (const ImuSample& sample : samples) {
    const Vec3& value = sample.*reading;
    mean += value / static_cast<double>(samples.size());
    least = least.cwiseMin(value);
    greatest = greatest.cwiseMax(value);
  }
  survey.limit = least.cwiseAbs().cwiseMax(greatest.cwiseAbs()).maxCoeff();
  std::array<size_t, 3> at_limit = {0, 0, 0}, near_limit = {0, 0, 0};
  for (const ImuSample& sample : samples) {
    square += (sample.*reading - mean).cwiseAbs2() / static_cast<double>(samples.size());
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::abs((sample.*reading)[axis]);
      constexpr double kNear = 0.98;
      if (size >= survey.limit * (1.0 - 1e-9)) {
        ++at_limit[static_cast<size_t>(axis)];
      } else if (size >= kNear * survey.limit) {
        ++near_limit[static_cast<size_t>(axis)];
      }
    }
  }
  survey.spread = square.cwiseSqrt();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<size_t>(axis);
    survey.is_dead[i] = samples.size() > 50 && survey.spread[axis] <= 0.02 * survey.spread.maxCoeff() &&
                        survey.spread[axis] < 1e-9 + 1e-6 * std::abs(mean[axis]);
    // An axis with constant readings is dead, not saturated.
    if (!survey.is_dead[i] && at_limit[i] > 5 && at_limit[i] > near_limit[i]) {
      survey.saturated_share = std::max(
          survey.saturated_share, static_cast<double>(at_limit[i]) / static_cast<double>(samples.size()));
    }
  }
  return survey;
}

/// Factor to m/s^2 if the norm of the readings can only be gravity in another unit; 1 where they are in m/s^2
/// or the unit is unknown.
double forceToSI(double median_force) {
  for (const double unit : {kStandardGravity_m_per_s2, 1e-3 * kStandardGravity_m_per_s2}) {
    const double gravity = kStandardGravity_m_per_s2 / unit;
    if (median_force > 0.75 * gravity && median_force < 1.3 * gravity) return unit;
  }
  return 1.0;
}

void surveyRest(const std::vector<Block>& blocks, ImuSurvey* survey) {
  constexpr double kRate_rad_per_s = 0.02, kForce_m_per_s2 = 0.15, kTurning_rad_per_s = 0.15;
  constexpr size_t kLeastBlocks = 6;
  Vec3 rate = Vec3::Zero();
  double force = 0.0;
  size_t count = 0;
  for (size_t i = 0; i + kLeastBlocks <= blocks.size(); ++i) {
    bool still = true;
    for (size_t k = i; k < i + kLeastBlocks; ++k) {
      still = still && blocks[k].rate_deviation < kRate_rad_per_s &&
              blocks[k].force_deviation < kForce_m_per_s2 &&
              (blocks[k].rate - blocks[i].rate).norm() < kRate_rad_per_s &&
              blocks[k].rate.norm() < kTurning_rad_per_s &&
              (blocks[k].force - blocks[i].force).norm() < kForce_m_per_s2;
    }
    if (!still) continue;
    rate += blocks[i].rate;
    force += blocks[i].force.norm();
    ++count;
  }
  if (count == 0) return;
  survey->rest_s = static_cast<double>(count) * kBlock_s;
  survey->rest_rate_B = rate / static_cast<double>(count);
  survey->rest_force_m_per_s2 = force / static_cast<double>(count);
}

std::optional<GravityTurning> compareWithGravity(const std::vector<Block>& blocks) {
  std::vector<Vec3> rates, forces, changes;
  for (size_t i = 0; i + 1 < blocks.size(); ++i) {
    const double step_s = blocks[i + 1].begin_s - blocks[i].begin_s;
    if (step_s > 2.0 * kBlock_s) continue;
    rates.push_back(0.5 * step_s * (blocks[i].rate + blocks[i + 1].rate));
    forces.push_back(0.5 * (blocks[i].force + blocks[i + 1].force));
    changes.push_back(blocks[i + 1].force - blocks[i].force);
  }
  if (changes.size() < 12) return std::nullopt;
  Vec3 mean_rate = Vec3::Zero();
  for (const Vec3& rate : rates) mean_rate += rate / static_cast<double>(rates.size());
  GravityTurning turning;
  for (const Mat3& axes : signedAxes()) {
    double products = 0.0, predicted = 0.0, seen = 0.0;
    for (size_t i = 0; i < rates.size(); ++i) {
      const Vec3 change = -(axes * (rates[i] - mean_rate)).cross(forces[i]);
      products += change.dot(changes[i]);
      predicted += change.squaredNorm();
      seen += changes[i].squaredNorm();
    }
    if (!(predicted > 0.0 && seen > 0.0)) return std::nullopt;
    const double correlation = products / std::sqrt(predicted * seen);
    if (axes.isIdentity()) {
      turning.correlation = correlation;
      turning.scale = products / predicted;
    }
    if (correlation <= turning.best_correlation) continue;
    turning.best_correlation = correlation;
    turning.best_axes = axes;
  }
  return turning;
}

/// See ImuSurvey::alternation_m_per_s2. A vibration at half the rate of the readings alternates as well, but
/// its phase drifts within a window.
double alternation_m_per_s2(const std::vector<ImuSample>& samples) {
  constexpr size_t kBlock = 50, kBlocksOfWindow = 8, kFewestWindows = 2;
  constexpr double kSteady = 0.9, kNearlyAll = 0.9, kLeast_m_per_s2 = 0.3;
  size_t windows = 0, steady = 0;
  double sum = 0.0;
  for (size_t first = 0; first + kBlock * kBlocksOfWindow <= samples.size(); ++windows) {
    Vec3 of_window = Vec3::Zero();
    double sizes = 0.0;
    for (size_t block = 0; block < kBlocksOfWindow; ++block, first += kBlock) {
      Vec3 difference = Vec3::Zero();
      for (size_t i = 0; i < kBlock; ++i)
        difference += (i % 2 == 0 ? 2.0 : -2.0) / kBlock * samples[first + i].specific_force_B;
      of_window += difference / kBlocksOfWindow;
      sizes += difference.norm() / kBlocksOfWindow;
    }
    sum += of_window.norm();
    steady += of_window.norm() > std::max(kLeast_m_per_s2, kSteady * sizes) ? 1 : 0;
  }
  if (windows < kFewestWindows || static_cast<double>(steady) < kNearlyAll * static_cast<double>(windows))
    return 0.0;
  return sum / static_cast<double>(windows);
}

}  // namespace

ImuSurvey surveyImu(MeasurementSource* source, Diagnostics* diagnostics) {
  ImuSurvey survey;
  StreamSurvey stream;
  std::vector<double> forces;
  std::optional<ImuSample> before;
  StreamExpectation expected{"imu", "imu0", source->rig().imu.rate_hz, 0.0, Duration()};
  expected.spreads_bursts = true;
  const auto pull = [&] {
    std::optional<ImuSample> sample = source->nextImu();
    if (!sample) return sample;
    stream.add(sample->time, before && isSame(*sample, *before));
    forces.push_back(sample->specific_force_B.norm());
    before = sample;
    return sample;
  };
  OrderedStream<ImuSample> ordered(expected, pull, diagnostics);
  while (ordered.peek() != nullptr) survey.samples.push_back(ordered.pop());
  survey.stream = stream.summarize(kImuGapPeriods);
  survey.stream.clock_jumps = diagnostics->count("imu_clock_jump");
  std::vector<ImuSample>& samples = survey.samples;
  if (samples.empty()) return survey;
  std::erase_if(samples, [](const ImuSample& sample) {
    return !sample.angular_velocity_B.allFinite() || !sample.specific_force_B.allFinite();
  });
  survey.gyroscope = surveyTriad(samples, &ImuSample::angular_velocity_B);
  survey.accelerometer = surveyTriad(samples, &ImuSample::specific_force_B);
  survey.median_force = median(forces);
  survey.force_to_SI = forceToSI(survey.median_force);
  for (ImuSample& sample : samples) sample.specific_force_B *= survey.force_to_SI;
  survey.alternation_m_per_s2 = alternation_m_per_s2(samples);
  InertialScreenOptions options;
  options.knows_rate_unit = false;
  samples = screened(samples, options, &survey.screening);
  Vec3 mean_force = Vec3::Zero();
  for (const ImuSample& sample : samples) mean_force += sample.specific_force_B;
  survey.up_B = mean_force.normalized();
  const std::vector<Block> blocks = blocksOf(samples);
  surveyRest(blocks, &survey);
  survey.turning = compareWithGravity(blocks);
  return survey;
}

}  // namespace lodeline

#include "apps/lodeline/tests/survey/test_cave_map.h"

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline::test {
namespace {

using Line = std::vector<Vec3>;

// Errors of heights: a random walk of 2 mm a keyframe that returns to 0, with a sigma of 0.03 m in the end.
constexpr double kHeightStep_m = 0.002;
constexpr double kHeightMemory = 0.9978;

/// Points one metre apart along a line of corners, with small waves.
Line resampled(const Line& corners) {
  Line line = {corners.front()};
  for (size_t i = 1; i < corners.size(); ++i) {
    const Vec3 leg = corners[i] - corners[i - 1];
    const auto steps = static_cast<int>(std::ceil(leg.norm()));
    for (int k = 1; k <= steps; ++k) line.push_back(corners[i - 1] + leg * k / steps);
  }
  return line;
}

Line reversed(Line line) {
  std::reverse(line.begin(), line.end());
  return line;
}

Line joined(const std::vector<Line>& lines) {
  Line all = lines.front();
  for (size_t i = 1; i < lines.size(); ++i) all.insert(all.end(), lines[i].begin() + 1, lines[i].end());
  return all;
}

Line part(const Line& line, size_t first, size_t last) {
  return {line.begin() + static_cast<std::ptrdiff_t>(first),
          line.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

double lengthOf(const Line& line) {
  double length = 0.0;
  for (size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

/// A keyframe as written, with the truth.
struct Written {
  KeyframeId id;
  Rigid3 truth;
};

class Diver {
 public:
  Diver(MapChange* change, unsigned seed, CaveMap* cave) : change_(change), random_(seed), cave_(cave) {}

  void swim(const std::string& name, int64_t start_s, const Line& line) {
    MapDive dive;
    dive.name = name;
    dive.start = Time::fromNanoseconds(start_s * 1000000000);
    dive.end = dive.start + Duration::fromSeconds(3.0 * static_cast<double>(line.size()));
    dive.heading_reference = HeadingReference::True;
    const DiveId id = change_->addDive(dive);
    MapKeyframe keyframe;
    keyframe.dive = id;
    Rigid3 odom = trueAt(line, 0);
    odom.translation.setZero();
    std::vector<Written> own;
    Mat6 covariance = 1e-10 * Mat6::Identity();
    double height_error_m = 0.0, height_variance = 1e-10;
    for (size_t i = 0; i < line.size(); ++i) {
      const Rigid3 truth = trueAt(line, i);
      if (i > 0) {
        const Rigid3 before = odom;
        odom = odom * withDrift(own.back().truth.inverse() * truth);
        covariance = propagated(covariance, before, odom);
        // The odometry uses the pressure sensor, which errs slowly.
        height_error_m = kHeightMemory * height_error_m + kHeightStep_m * normal();
        odom.translation.z() = truth.translation.z() - line.front().z() + height_error_m;
        height_variance = kHeightMemory * kHeightMemory * height_variance + kHeightStep_m * kHeightStep_m;
        covariance.row(2).setZero();
        covariance.col(2).setZero();
        covariance(2, 2) = height_variance;
      }
      keyframe.id = -1;
      keyframe.time = dive.start + Duration::fromSeconds(3.0 * static_cast<double>(i));
      keyframe.odom_from_body = odom;
      keyframe.covariance = covariance;
      // North is known at the start, and carried on by odometry.
      keyframe.heading_sigma_rad = std::hypot(0.01, std::sqrt(covariance(5, 5)));
      keyframe.depth_m = ScalarPrior{2.0 - line.front().z() - odom.translation.z(), 0.03};
      const KeyframeId made = change_->addKeyframe(keyframe);
      // A rough pose; the common solution replaces it.
      Rigid3 rough = odom;
      rough.translation += line.front();
      change_->setSolution(made, {rough, Mat6::Identity()});
      own.push_back({made, truth});
      cave_->truth[keyframe.time.nanoseconds()] = truth.translation;
      if (i % 4 == 0) recognize(own);
    }
    seen_.insert(seen_.end(), own.begin(), own.end());
  }

 private:
  double normal() { return std::normal_distribution<double>()(random_); }
  Vec3 normal3() { return {normal(), normal(), normal()}; }

  static Rigid3 trueAt(const Line& line, size_t i) {
    const Vec3 along = i + 1 < line.size() ? Vec3(line[i + 1] - line[i]) : Vec3(line[i] - line[i - 1]);
    const double azimuth = std::atan2(along.y(), along.x());
    return {so3::exp(azimuth * Vec3::UnitZ()), line[i]};
  }

  Rigid3 withDrift(Rigid3 step) {
    step.translation += Vec3(0.02 * normal(), 0.02 * normal(), 0.01 * normal());
    step.rotation = step.rotation * so3::exp(0.002 * normal() * Vec3::UnitZ());
    return step;
  }

  /// Covariance of [dp, dtheta] in world axes after a step with the errors of withDrift().
  static Mat6 propagated(const Mat6& covariance, const Rigid3& before, const Rigid3& after) {
    Mat6 transition = Mat6::Identity();
    transition.topRightCorner<3, 3>() = -so3::skew(after.translation - before.translation);
    Mat6 added = Mat6::Zero();
    added.diagonal() << 4e-4, 4e-4, 1e-4, 1e-8, 1e-8, 4e-6;
    return transition * covariance * transition.transpose() + added;
  }

  /// A loop with the nearest earlier keyframe within 1.5 m.
  void recognize(const std::vector<Written>& own) {
    const Written& now = own.back();
    const Written* old = nullptr;
    const auto consider = [&](const Written& row) {
      const double distance_m = (row.truth.translation - now.truth.translation).norm();
      if (distance_m > 1.5) return;
      if (old == nullptr || distance_m < (old->truth.translation - now.truth.translation).norm()) old = &row;
    };
    for (const Written& row : seen_) consider(row);
    for (size_t i = 0; i + 20 < own.size(); ++i) consider(own[i]);
    if (old == nullptr) return;
    Loop loop;
    loop.old_keyframe = old->id;
    loop.new_keyframe = now.id;
    loop.source = "geometry";
    loop.status = LoopStatus::Accepted;
    loop.old_from_new = old->truth.inverse() * now.truth;
    loop.old_from_new.translation += 0.03 * normal3();
    loop.old_from_new.rotation = so3::exp(0.005 * normal3()) * loop.old_from_new.rotation;
    Vec6 variances;
    variances << 9e-4, 9e-4, 9e-4, 2.5e-5, 2.5e-5, 2.5e-5;
    loop.covariance = variances.asDiagonal();
    change_->addLoop(loop);
  }

  MapChange* change_;
  std::mt19937 random_;
  CaveMap* cave_;
  std::vector<Written> seen_;
};

}  // namespace

CaveMap::CaveMap(const std::filesystem::path& file, unsigned seed) {
  const Line main = resampled({{0, 0, 0}, {30, 4, -6}, {60, -8, -10}, {95, 2, -14}, {130, 10, -12}});
  const size_t leaves = 32, returns = 98;
  const Line side = resampled({main[leaves], {38, 22, -9}, {70, 34, -12}, {96, 20, -13}, main[returns]});
  const Line sink = resampled({{190, 60, 0}, {170, 40, -8}, {150, 22, -13}, main.back()});
  entrance_B = sink.front();
  passages_m = lengthOf(main) + lengthOf(side) + lengthOf(sink);
  MapFile map = MapFile::create(file, {});
  MapChange change = map.change();
  Diver diver(&change, seed, this);
  diver.swim("upstream", 1795255200, joined({main, reversed(main)}));
  diver.swim("loop", 1795341600, joined({part(main, 0, leaves), side, reversed(part(main, 0, returns))}));
  const Line to_the_side = part(main, 80, main.size() - 1);
  diver.swim("sink", 1795428000, joined({sink, reversed(to_the_side), to_the_side, reversed(sink)}));
  change.commit();
  unconnected = solveMap(&map, {}).unconnected;
}

}  // namespace lodeline::test

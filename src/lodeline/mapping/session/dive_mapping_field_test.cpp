// Loops of a dive of points between plates of steel, from keyframes to loops.csv: places that look alike are
// told apart by their magnetic fields.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/test_loop_scene.h"
#include "lodeline/mapping/session/dive_mapping.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "simulation/sensors/magnetic_disturbance.h"

namespace lodeline {
namespace {

constexpr double kNoise_T = 0.1e-6;
const Vec3 kSteelEarth_W(1e-6, 24e-6, -38e-6);

/// A passage along x. Its part from -18 m to -10 m looks the same as the part from 2 m to 10 m. Plates of
/// steel, each magnetized in another way, are on both sides of the whole passage.
class SteelPassage {
 public:
  explicit SteelPassage(uint64_t seed) : maker_(seed) {
    for (int i = 0; i < 800; ++i) {
      const double radius_m = maker_.uniform(1.2, 2.6), angle = maker_.uniform(-M_PI, M_PI);
      const Vec3 place(maker_.uniform(-28.0, 22.0), radius_m * std::cos(angle), radius_m * std::sin(angle));
      const Descriptor look = maker_.look();
      if (place.x() > -18.0 && place.x() < -10.0) continue;
      points_.push_back({place, look});
      if (place.x() > 2.0 && place.x() < 10.0) points_.push_back({place - kApart_m * Vec3::UnitX(), look});
    }
    for (double x = -32.0; x <= 24.0; x += 2.0) {
      for (const double y : {-3.0, 3.0}) {
        for (const double z : {-1.0, 1.0})
          steel_.push_back({Vec3(x, y, z), Vec3(80.0, 100.0, -200.0) + maker_.normal3(200.0)});
      }
    }
  }

  /// A keyframe of a body at a pose, with the points in its view. In the dark it has none.
  MapKeyframe keyframe(const Rigid3& truth, bool is_dark) {
    std::vector<ScenePoint> seen;
    for (const ScenePoint& point : points_) {
      const Vec3 p = truth.inverse() * point.position_W;
      const bool is_in_view = std::abs(p.y()) < 0.84 * p.x() && std::abs(p.z()) < 0.84 * p.x();
      if (!is_dark && is_in_view && p.norm() < 6.0) seen.push_back(point);
    }
    MapKeyframe keyframe = maker_.keyframe(seen, truth);
    const Vec3 field_W = kSteelEarth_W + fieldOfDipoles(steel_, truth.translation);
    keyframe.field = KeyframeField{truth.rotation.conjugate() * field_W + maker_.normal3(kNoise_T), kNoise_T};
    return keyframe;
  }

  static constexpr double kApart_m = 20.0;  ///< between the places that look alike

 private:
  SceneMaker maker_;
  std::vector<ScenePoint> points_;
  std::vector<LyingDipole> steel_;
};

/// True poses of a body, and whether it is dark there.
using Way = std::vector<std::pair<Rigid3, bool>>;

void swim(double from_m, double to_m, double beside_m, Way* way) {
  for (double x = from_m; x <= to_m; x += 0.5) {
    const double wave = 0.3 * std::sin(x);
    way->emplace_back(
        Rigid3(so3::exp(Vec3(0.05 * wave, -0.1 * wave, 0.2 * wave)), Vec3(x, wave + beside_m, 0.1 * wave)),
        false);
  }
}

/// A way from -4 m to 16 m, a way back in the dark far beside the passage, and a second way from -24 m to 10
/// m. So the second way comes first through the part that the first has not seen.
Way wayThroughThePassage() {
  Way way;
  swim(-4.0, 16.0, 0.0, &way);
  const std::vector<Vec3> corners = {
      {16.0, 0.0, 0.0}, {16.0, 40.0, 0.0}, {-26.0, 40.0, 0.0}, {-26.0, 0.0, 0.0}};
  for (size_t i = 1; i < corners.size(); ++i) {
    const Vec3 leg = corners[i] - corners[i - 1];
    for (double m = 2.0; m < leg.norm(); m += 2.0)
      way.emplace_back(Rigid3(Quat::Identity(), corners[i - 1] + m * leg.normalized()), true);
  }
  swim(-24.0, 10.0, 0.15, &way);
  return way;
}

/// What a dive leaves: the rows of loops.csv beside the loops that they are of.
struct SteelDive {
  std::vector<Loop> ledger;
  std::vector<std::string> rows;
  std::vector<bool> is_true;  ///< by the true poses

  int count(bool is_wanted, const std::string& text) const {
    int sum = 0;
    for (size_t i = 0; i < rows.size(); ++i)
      sum += is_true[i] == is_wanted && rows[i].find(text) != std::string::npos;
    return sum;
  }
};

/// Adds the keyframes of a way to a map, and their true poses to `truth`. `iron_B`: hard iron of the sensor;
/// empty without a magnetometer.
void addWay(const Way& way, const std::optional<Vec3>& iron_B, SteelPassage* passage, DiveMapping* mapping,
            std::vector<Rigid3>* truth) {
  // In the dark the odometry drifts by 5 m towards the place that looks alike, one sigma of its claim.
  Rigid3 odom_from_truth;
  Mat6 covariance = 1e-6 * Mat6::Identity();
  std::optional<Vec3> last;
  Time time = Time::fromSeconds(100.0);
  for (const auto& [pose, is_dark] : way) {
    if (is_dark) odom_from_truth.translation += Vec3(5.0, 1.0, 0.1) / 58.0;
    MapKeyframe keyframe = passage->keyframe(pose, is_dark);
    if (iron_B) {
      keyframe.field->field_B += *iron_B;
    } else {
      keyframe.field.reset();
    }
    time = keyframe.time = time + Duration::fromSeconds(1.0);
    keyframe.odom_from_body = odom_from_truth * pose;
    const double step_m = last ? (pose.translation - *last).norm() : 0.0;
    last = pose.translation;
    const double sigma_m = is_dark ? 0.55 * std::sqrt(step_m) : 0.005 * std::sqrt(step_m);
    covariance.diagonal() += (Eigen::Matrix<double, 6, 1>() << Vec2::Constant(sigma_m * sigma_m),
                              0.04 * sigma_m * sigma_m, Vec3::Constant(1e-6 * step_m))
                                 .finished();
    keyframe.covariance = covariance;
    mapping->add(std::move(keyframe));
    truth->push_back(pose);
  }
  mapping->finish(time);
}

/// An empty folder for maps.
std::filesystem::path newFolder() {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "lodeline_steel_dive";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

MapDive named(const std::string& name) {
  MapDive dive;
  dive.name = name;
  return dive;
}

SteelDive ledgerOf(const DiveMapping& mapping, const std::vector<Rigid3>& truth,
                   const std::filesystem::path& folder) {
  SteelDive dive;
  dive.ledger = mapping.ledger();
  {
    LoopLedger ledger(folder / "loops.csv");
    for (const Loop& loop : dive.ledger) {
      const KnownKeyframes& known = mapping.known();
      ledger.write(loop,
                   {"steel", "steel", known.at(loop.old_keyframe).time, known.at(loop.new_keyframe).time});
      const Rigid3 relative = truth[static_cast<size_t>(loop.old_keyframe - 1)].inverse() *
                              truth[static_cast<size_t>(loop.new_keyframe - 1)];
      dive.is_true.push_back((relative.translation - loop.old_from_new.translation).norm() < 0.5);
    }
  }
  std::ifstream stream(folder / "loops.csv");
  std::string row;
  std::getline(stream, row);  // names of the columns
  while (std::getline(stream, row)) dive.rows.push_back(row);
  return dive;
}

SteelDive diveThroughSteel(bool has_magnetometer) {
  const std::filesystem::path folder = newFolder();
  SteelPassage passage(3);
  MapFile file = MapFile::create(folder / "map.db", {});
  DiveMapping mapping(&file, named("steel"), nullptr, {});
  std::vector<Rigid3> truth;
  addWay(wayThroughThePassage(), has_magnetometer ? std::optional(Vec3(Vec3::Zero())) : std::nullopt,
         &passage, &mapping, &truth);
  return ledgerOf(mapping, truth, folder);
}

/// A dive through the passage, and another one by another sensor. It begins at the place that looks alike,
/// and ends at the true one.
SteelDive twoDivesThroughSteel(uint64_t seed, bool has_magnetometer) {
  const std::filesystem::path folder = newFolder();
  SteelPassage passage(seed);
  MapFile files[] = {MapFile::create(folder / "first.db", {}), MapFile::create(folder / "second.db", {})};
  Way first_way, second_way;
  swim(-4.0, 16.0, 0.0, &first_way);
  swim(-17.0, 12.0, 0.15, &second_way);
  std::vector<Rigid3> truth;
  const auto iron = [&](const Vec3& iron_B) {
    return has_magnetometer ? std::optional(iron_B) : std::nullopt;
  };
  DiveMapping first(&files[0], named("first"), nullptr, {});
  addWay(first_way, iron(Vec3::Zero()), &passage, &first, &truth);
  DiveMapping second(&files[1], named("second"), &files[0], {});
  addWay(second_way, iron(Vec3(4e-6, -5e-6, 3e-6)), &passage, &second, &truth);
  return ledgerOf(second, truth, folder);
}

/// The last column of a row.
double logRatioIn(const std::string& row) { return std::stod(row.substr(row.rfind(',') + 1)); }

TEST(DiveMapping, TellsPlacesThatLookAlikeApartByTheirMagneticField) {
  const SteelDive with = diveThroughSteel(true);
  ASSERT_EQ(with.rows.size(), with.ledger.size());
  const int refused = with.count(false, ",refused,the magnetic fields of both ways differ");
  RecordProperty("false_refused_by_field", refused);
  RecordProperty("true_accepted", with.count(true, ",accepted,"));
  EXPECT_GT(refused, 50);
  EXPECT_GT(with.count(true, ",accepted,"), 70);
  EXPECT_EQ(with.count(true, ",refused,the magnetic fields"), 0);
  int supported = 0;
  for (size_t i = 0; i < with.rows.size(); ++i) {
    if (with.ledger[i].status != LoopStatus::Accepted) continue;
    EXPECT_TRUE(with.is_true[i]) << with.rows[i];
    supported += logRatioIn(with.rows[i]) > 3.0;
  }
  RecordProperty("true_supported", supported);
  EXPECT_GE(supported, 9 * with.count(true, ",accepted,") / 10);
}

// The same images and odometry: nothing but the field knows better.
TEST(DiveMapping, WithoutAFieldPlacesThatLookAlikeAreTakenForOne) {
  const SteelDive without = diveThroughSteel(false);
  RecordProperty("false_accepted", without.count(false, ",accepted,"));
  EXPECT_GT(without.count(false, ",accepted,"), 30);
  for (const std::string& row : without.rows) EXPECT_EQ(row.substr(row.size() - 10), ",nan,0,nan") << row;
}

// At the start of a dive, few readings are known.
TEST(DiveMapping, ADiveThatBeginsWhereItLooksAlikeWaitsForItsField) {
  int true_accepted = 0, false_refused = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SteelDive with = twoDivesThroughSteel(seed, true);
    for (size_t i = 0; i < with.rows.size(); ++i) {
      const bool is_accepted = with.ledger[i].status == LoopStatus::Accepted;
      EXPECT_TRUE(with.is_true[i] || !is_accepted) << "seed " << seed << ": " << with.rows[i];
    }
    EXPECT_GT(with.count(true, ",accepted,"), 10) << seed;
    true_accepted += with.count(true, ",accepted,");
    false_refused += with.count(false, ",refused,");
    EXPECT_GT(twoDivesThroughSteel(seed, false).count(false, ",accepted,"), 5) << seed;
  }
  RecordProperty("between_dives_true_accepted", true_accepted);
  RecordProperty("between_dives_false_refused", false_refused);
  EXPECT_GT(false_refused, 50);
}

}  // namespace
}  // namespace lodeline

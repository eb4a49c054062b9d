#include "lodeline/mapping/session/loops/field_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/session/dive_mapping.h"

// Loops along a hull: a row of dipoles on both sides of the way, as in the tests of the field map.

namespace lodeline {
namespace {

constexpr double kStep_m = 0.4;
constexpr int kKeyframes = 60;  // of each way
const Vec3 kEarth_W(1e-6, 24e-6, -38e-6);

struct HullDipole {
  Vec3 place, moment;  ///< m, A m^2
};

/// A field of the model: the gradient of a sum of waves with the spectrum of a squared exponential covariance
/// (random Fourier features).
class ModelField {
 public:
  ModelField(const FieldMapOptions& options, std::mt19937_64& random) : options_(options) {
    std::normal_distribution<double> normal(0.0, 1.0 / options.length_scale_m);
    std::uniform_real_distribution<double> turn(0.0, 2.0 * M_PI);
    for (int i = 0; i < kWaves; ++i)
      waves_.emplace_back(normal(random), normal(random), normal(random), turn(random));
  }
  Vec3 at(const Vec3& place) const {
    const double size = options_.field_sigma_T * options_.length_scale_m * std::sqrt(2.0 / kWaves);
    Vec3 sum = Vec3::Zero();
    for (const Eigen::Vector4d& wave : waves_)
      sum -= size * std::sin(wave.head<3>().dot(place) + wave[3]) * wave.head<3>();
    return sum;
  }

 private:
  static constexpr int kWaves = 300;
  FieldMapOptions options_;
  std::vector<Eigen::Vector4d> waves_;
};

class FieldSupportTest : public testing::Test {
 protected:
  Vec3 normal3(double sigma) { return sigma * Vec3(normal_(random_), normal_(random_), normal_(random_)); }

  /// Plates of a hull, each magnetized in another way.
  void addHull() {
    for (double x = -4.0; x <= kKeyframes * kStep_m + 4.0; x += 2.0) {
      for (const double y : {-3.0, 3.0}) {
        for (const double z : {-1.0, 1.0})
          dipoles_.push_back({Vec3(x, y, z), Vec3(80.0, 100.0, -200.0) + normal3(120.0)});
      }
    }
  }

  Vec3 fieldAt(const Vec3& place) const {
    Vec3 sum = kEarth_W + (model_ ? model_->at(place) : Vec3(Vec3::Zero()));
    for (const HullDipole& dipole : dipoles_) {
      const Vec3 offset = place - dipole.place;
      const double r = offset.norm();
      sum +=
          1e-7 * (3.0 * offset * dipole.moment.dot(offset) / std::pow(r, 5) - dipole.moment / std::pow(r, 3));
    }
    return sum;
  }

  /// Two ways along x through the hull, the second beside the first. Numbers 0 and up, 100 and up. Odometry
  /// of the second is in a world that has turned and moved, so nothing but the loop joins them.
  /// `turned_rad`: heading of the second way's bodies against the first's. `offset_B`: hard iron.
  void swim(double turned_rad = 0.0, const Vec3& offset_B = Vec3::Zero(), double beside_m = 0.2) {
    known_ = {};
    for (const int dive : std::set<int>{1, second_.dive}) known_.startDive(dive, {});
    for (int i = 0; i < 2 * kKeyframes; ++i) {
      const bool is_second = i >= kKeyframes;
      const int k = i % kKeyframes;
      const double wave = 0.3 * std::sin(0.4 * k);
      Rigid3 truth(so3::exp(Vec3(0.05 * wave, -0.1 * wave, 0.2 * wave)), Vec3(kStep_m * k, wave, 0.1 * wave));
      if (is_second) {
        truth.translation += Vec3(0.1, beside_m, 0.1);
        truth.rotation = so3::exp(turned_rad * Vec3::UnitZ()) * truth.rotation;
      }
      truth_.push_back(truth);
      KnownKeyframe keyframe;
      keyframe.id = is_second ? 100 + k : k;
      keyframe.dive = is_second ? second_.dive : 1;
      keyframe.path_m = kStep_m * i + (is_second ? 100.0 : 0.0);
      keyframe.odom_from_body = is_second ? drifted_ * truth : truth;
      keyframe.map_from_body = keyframe.odom_from_body;
      keyframe.field = KeyframeField{truth.rotation.conjugate() * fieldAt(truth.translation) + offset_B +
                                         normal3(noise_T_) + normal3(unmodelled_T_),
                                     noise_T_};
      RelativePose step;
      step.covariance = 1e-6 * Mat6::Identity();
      if (is_second) keyframe.field->field_B = second_.axes * keyframe.field->field_B + second_.offset_B;
      const bool begins = i == 0 || known_.all().back().dive != keyframe.dive;
      if (!begins) step.from_from_to = known_.all().back().odom_from_body.inverse() * keyframe.odom_from_body;
      known_.add(keyframe, begins ? nullptr : &step);
    }
  }

  /// A verified loop that claims that place `claimed` of the second way is place `old_place` of the first,
  /// with errors by its covariance.
  Loop loop(int old_place, int claimed, int new_place) {
    Loop loop;
    loop.old_keyframe = old_place;
    loop.new_keyframe = 100 + new_place;
    loop.status = LoopStatus::Verified;
    loop.old_from_new =
        truth_[static_cast<size_t>(old_place)].inverse() * truth_[static_cast<size_t>(kKeyframes + claimed)];
    constexpr double kSigma_m = 0.05, kSigma_rad = 0.01;
    loop.old_from_new.translation += normal3(kSigma_m);
    loop.old_from_new.rotation = so3::exp(normal3(kSigma_rad)) * loop.old_from_new.rotation;
    loop.covariance = Mat6::Identity();
    loop.covariance.topLeftCorner<3, 3>() *= kSigma_m * kSigma_m;
    loop.covariance.bottomRightCorner<3, 3>() *= kSigma_rad * kSigma_rad;
    return loop;
  }
  Loop trueLoop(int place) { return loop(place, place, place); }
  /// The place `metres` further on that looks alike.
  Loop falseLoop(int place, double metres) {
    return loop(place, place, place + static_cast<int>(std::lround(metres / kStep_m)));
  }

  /// Of the second way: its dive, and what its sensor has beyond that of the first.
  struct {
    int dive = 1;
    Mat3 axes = Mat3::Identity();
    Vec3 offset_B = Vec3::Zero();
  } second_;
  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
  double noise_T_ = 0.1e-6;          ///< as drawn
  double unmodelled_T_ = 0.0;        ///< drawn beside it, per axis
  std::optional<ModelField> model_;  ///< beside the dipoles
  Rigid3 drifted_{so3::exp(0.4 * Vec3::UnitZ()), Vec3(3.0, -2.0, 0.5)};
  std::vector<HullDipole> dipoles_;
  std::vector<Rigid3> truth_;
  KnownKeyframes known_;
};

TEST_F(FieldSupportTest, SupportsTrueLoopsAndContradictsFalseOnes) {
  double chi_squared = 0.0;
  int values = 0, supported = 0, loops = 0, kept = 0, refused = 0;
  for (int hull = 0; hull < 6; ++hull) {
    dipoles_.clear();
    truth_.clear();
    addHull();
    swim();
    for (int place = 12; place < 45; place += 4) {
      Loop right = trueLoop(place), wrong = falseLoop(place, 4.0);
      judgeByField(known_, &right);
      judgeByField(known_, &wrong);
      ASSERT_TRUE(right.field && wrong.field);
      ++loops;
      chi_squared += right.field->chi_squared;
      values += right.field->values;
      supported += right.field->log_ratio > 3.0;
      kept += right.status == LoopStatus::Verified;
      refused += wrong.status == LoopStatus::Refused;
      EXPECT_EQ(wrong.status == LoopStatus::Refused, !wrong.reason.empty());
    }
  }
  RecordProperty("chi_squared_per_value", std::to_string(chi_squared / values));
  RecordProperty("supported", supported);
  RecordProperty("refused", refused);
  RecordProperty("loops", loops);
  EXPECT_EQ(kept, loops) << "no true loop may be refused";
  EXPECT_LT(chi_squared / values, 1.0) << "the noise is half of what is expected near steel";
  EXPECT_GE(supported, 9 * loops / 10);
  EXPECT_GE(refused, 9 * loops / 10);
}

// Fields, errors and poses drawn from the model: chi-squared has its mean.
TEST_F(FieldSupportTest, IsCalibratedForFieldsOfItsModel) {
  const FieldSupportOptions options;
  unmodelled_T_ = options.floor_T;
  double chi_squared = 0.0;
  int values = 0;
  for (int field = 0; field < 40; ++field) {
    truth_.clear();
    model_.emplace(options.map, random_);
    swim(0.0, normal3(options.offset_sigma_T));
    for (const int place : {14, 30, 46}) {
      const FieldAgreement agreement = fieldSupport(known_, trueLoop(place), options).value();
      chi_squared += agreement.chi_squared;
      values += agreement.values;
    }
  }
  RecordProperty("model_chi_squared_per_value", std::to_string(chi_squared / values));
  EXPECT_NEAR(chi_squared / values, 1.0, 0.12);
}

TEST_F(FieldSupportTest, SaysNothingInTheEarthsField) {
  swim();
  for (int place = 12; place < 45; place += 4) {
    for (Loop loop : {trueLoop(place), falseLoop(place, 4.0)}) {
      judgeByField(known_, &loop);
      EXPECT_FALSE(loop.field);
      EXPECT_EQ(loop.status, LoopStatus::Verified);
    }
  }
}

TEST_F(FieldSupportTest, SaysNothingWhereTheWaysDoNotMeetOrReadingsAreMissing) {
  addHull();
  swim();
  Loop beside = trueLoop(20);
  beside.old_from_new.translation.y() += 8.0;
  EXPECT_FALSE(fieldSupport(known_, beside));
  for (KnownKeyframe& keyframe : known_.all()) {
    if (keyframe.id >= 100 && keyframe.id != 120 && keyframe.id != 121) keyframe.field.reset();
  }
  EXPECT_FALSE(fieldSupport(known_, trueLoop(20)));
}

// Two places 2.4 m apart on one way: no reading may support itself. Three readings before the middle remain
// within a length scale of those behind it.
TEST_F(FieldSupportTest, ComparesNoReadingWithItself) {
  addHull();
  swim();
  Loop loop;
  loop.old_keyframe = 20;
  loop.new_keyframe = 26;
  loop.status = LoopStatus::Verified;
  loop.old_from_new = truth_[20].inverse() * truth_[26];
  loop.covariance = 1e-4 * Mat6::Identity();
  EXPECT_EQ(fieldSupport(known_, loop).value().values, 9);
}

// Another dive by another rig, whose sensor nobody has calibrated.
TEST_F(FieldSupportTest, JudgesLoopsBetweenDivesOfDifferentSensors) {
  int loops = 0, kept = 0, refused = 0;
  for (int hull = 0; hull < 6; ++hull) {
    dipoles_.clear();
    truth_.clear();
    addHull();
    second_.dive = 2;
    second_.offset_B = normal3(5e-6);
    for (int column = 0; column < 3; ++column) second_.axes.col(column) = Vec3::Unit(column) + normal3(0.02);
    swim();
    for (int place = 12; place < 45; place += 4) {
      Loop right = trueLoop(place), wrong = falseLoop(place, 4.0);
      judgeByField(known_, &right);
      judgeByField(known_, &wrong);
      ASSERT_TRUE(right.field && wrong.field);
      ++loops;
      kept += right.status == LoopStatus::Verified;
      refused += wrong.status == LoopStatus::Refused;
    }
  }
  RecordProperty("refused_between_dives", refused);
  EXPECT_EQ(kept, loops) << "no true loop may be refused";
  EXPECT_GE(refused, 8 * loops / 10);
}

// A map keeps the field, so that a later dive compares its own with it.
TEST_F(FieldSupportTest, JudgesLoopsWithAMapOfAnEarlierDive) {
  addHull();
  second_.dive = 2;
  swim();
  const test::TemporaryFolder folder;
  MapFile own[] = {MapFile::create(folder.path() / "first.db", {}),
                   MapFile::create(folder.path() / "second.db", {})};
  std::vector<std::unique_ptr<DiveMapping>> dives;
  for (int number = 0; number < 2; ++number) {
    MapDive dive;
    dive.name = number == 0 ? "first" : "second";
    dives.push_back(
        std::make_unique<DiveMapping>(&own[number], dive, number == 0 ? nullptr : &own[0], MappingOptions{}));
    for (const KnownKeyframe& swum : known_.all()) {
      if (swum.dive != number + 1) continue;
      MapKeyframe keyframe;
      keyframe.time = Time::fromNanoseconds(1'000'000'000 * swum.id);
      keyframe.odom_from_body = swum.odom_from_body;
      keyframe.covariance = 1e-6 * static_cast<double>(1 + swum.id) * Mat6::Identity();
      keyframe.field = swum.field;
      dives.back()->add(keyframe);
    }
    dives.back()->finish(Time::fromNanoseconds(1'000'000'000'000));
  }
  const KnownKeyframes& known = dives.back()->known();
  ASSERT_EQ(known.all().size(), 2u * kKeyframes);
  // Numbers of a map begin with 1, and those of the second dive follow.
  const auto renamed = [](Loop loop) {
    loop.old_keyframe += 1;
    loop.new_keyframe += 1 + kKeyframes - 100;
    return loop;
  };
  for (int place = 12; place < 45; place += 8) {
    Loop right = renamed(trueLoop(place)), wrong = renamed(falseLoop(place, 4.0));
    judgeByField(known, &right);
    judgeByField(known, &wrong);
    ASSERT_TRUE(right.field) << place;
    EXPECT_GT(right.field->log_ratio, 0.0) << place;
    EXPECT_EQ(right.status, LoopStatus::Verified);
    EXPECT_EQ(wrong.status, LoopStatus::Refused) << place;
  }
}

// Hard iron that nobody knows is the same on both ways where the rig looks the same way.
TEST_F(FieldSupportTest, UnknownIronRefusesNoTrueLoop) {
  for (const double turned_rad : {0.0, M_PI}) {
    for (int hull = 0; hull < 3; ++hull) {
      dipoles_.clear();
      truth_.clear();
      addHull();
      swim(turned_rad, Vec3(4e-6, -3e-6, 2e-6));
      for (int place = 12; place < 45; place += 4) {
        Loop loop = trueLoop(place);
        judgeByField(known_, &loop);
        ASSERT_TRUE(loop.field);
        EXPECT_EQ(loop.status, LoopStatus::Verified) << loop.reason << " turned by " << turned_rad;
      }
    }
  }
}

// The result depends on no choice of axes: another world of the odometry gives the same numbers.
TEST_F(FieldSupportTest, IsInvariantToTheWorldOfTheOdometry) {
  addHull();
  swim();
  const Loop loop = trueLoop(20);
  const FieldAgreement before = fieldSupport(known_, loop).value();
  const Rigid3 other(so3::exp(Vec3(0.0, 0.0, 2.1)), Vec3(100.0, -40.0, 9.0));
  for (KnownKeyframe& keyframe : known_.all()) keyframe.odom_from_body = other * keyframe.odom_from_body;
  const FieldAgreement after = fieldSupport(known_, loop).value();
  EXPECT_NEAR(after.chi_squared, before.chi_squared, 1e-5 * before.chi_squared);
  EXPECT_NEAR(after.log_ratio, before.log_ratio, 1e-4);
}

}  // namespace
}  // namespace lodeline

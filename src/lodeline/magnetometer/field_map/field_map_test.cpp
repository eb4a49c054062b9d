#include "lodeline/magnetometer/field_map/field_map.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace lodeline {
namespace {

constexpr double kNoise_T = 0.2e-6;

struct MapDipole {
  Vec3 place, moment;  ///< m, A m^2
};

Vec3 fieldOf(const std::vector<MapDipole>& dipoles, const Vec3& place) {
  Vec3 sum = Vec3::Zero();
  for (const MapDipole& dipole : dipoles) {
    const Vec3 offset = place - dipole.place;
    const double r = offset.norm();
    sum +=
        1e-7 * (3.0 * offset * dipole.moment.dot(offset) / std::pow(r, 5) - dipole.moment / std::pow(r, 3));
  }
  return sum;
}

/// Plates on both sides of a path along x, 3 m away.
std::vector<MapDipole> plates(uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<MapDipole> dipoles;
  for (double x = -12.0; x <= 12.0; x += 2.0) {
    for (const double y : {-3.0, 3.0}) {
      for (const double z : {-1.0, 1.0}) {
        dipoles.push_back({Vec3(x, y, z), Vec3(80.0, 100.0, -200.0) +
                                              120.0 * Vec3(normal(random), normal(random), normal(random))});
      }
    }
  }
  return dipoles;
}

struct MapReading {
  Vec3 place, anomaly;
};

/// Readings with noise every 0.25 m along x, on a path that swings by half a metre.
std::vector<MapReading> passBy(const std::vector<MapDipole>& dipoles, uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<MapReading> readings;
  for (double x = -10.0; x <= 10.0; x += 0.25) {
    const Vec3 place(x, 0.5 * std::sin(0.8 * x), 0.3 * std::cos(0.5 * x));
    readings.push_back(
        {place, fieldOf(dipoles, place) + kNoise_T * Vec3(normal(random), normal(random), normal(random))});
  }
  return readings;
}

const Mat3 kNoise = kNoise_T * kNoise_T * Mat3::Identity();

TEST(FieldMapTile, IsThePriorWhereNothingWasLearnt) {
  const PotentialBasis basis(4.5, 1.5, 6e-6);
  FieldMapTile tile(basis, Vec3(10.0, -20.0, 3.0));
  const PredictedField nothing = tile.predict(Vec3(10.5, -20.0, 3.0));
  EXPECT_EQ(nothing.field, Vec3(Vec3::Zero()));
  EXPECT_GT(nothing.covariance.diagonal().minCoeff(), 0.75 * 36e-12);
  tile.add(Vec3(7.5, -22.5, 0.5), Vec3(9e-6, 3e-6, -4e-6), kNoise);
  // Three length scales away along each axis.
  const Vec3 place(12.5, -17.5, 5.5);
  const PredictedField far = tile.predict(place), prior = FieldMapTile(basis, tile.centre()).predict(place);
  EXPECT_LT(far.field.norm(), 0.5e-6);
  EXPECT_GT((far.covariance.diagonal().array() / prior.covariance.diagonal().array()).minCoeff(), 0.98);
  const PredictedField near = tile.predict(Vec3(7.5, -22.5, 0.5));
  EXPECT_LT((near.field - Vec3(9e-6, 3e-6, -4e-6)).norm(), 0.2e-6);
  EXPECT_LT(near.covariance.diagonal().maxCoeff(), 1.1 * kNoise_T * kNoise_T);
}

TEST(FieldMapTile, OrderOfReadingsDoesNotMatter) {
  const PotentialBasis basis(4.5, 1.5, 6e-6);
  std::vector<MapReading> readings = passBy(plates(1), 2);
  std::erase_if(readings, [](const MapReading& r) { return std::abs(r.place.x()) > 3.0; });
  FieldMapTile forwards(basis, Vec3::Zero()), backwards(basis, Vec3::Zero());
  for (const MapReading& r : readings) forwards.add(r.place, r.anomaly, kNoise);
  std::reverse(readings.begin(), readings.end());
  for (const MapReading& r : readings) backwards.add(r.place, r.anomaly, kNoise);
  const Vec3 place(0.4, 0.2, -0.1);
  const PredictedField a = forwards.predict(place), b = backwards.predict(place);
  EXPECT_LT((a.field - b.field).norm(), 1e-6 * a.field.norm());
  EXPECT_LT((a.covariance - b.covariance).norm(), 1e-6 * a.covariance.norm());
}

TEST(FieldMapTile, CovarianceOfAFieldOfItsModelIsCalibrated) {
  const PotentialBasis basis(4.5, 1.5, 6e-6);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  const auto normal3 = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  double nees = 0.0;
  int count = 0;
  for (int field = 0; field < 60; ++field) {
    Eigen::VectorXd weights(basis.size());
    for (int j = 0; j < basis.size(); ++j)
      weights[j] = std::sqrt(basis.weightVariances()[j]) * normal(random);
    FieldMapTile tile(basis, Vec3::Zero());
    for (int i = 0; i < 25; ++i) {
      const Vec3 place(-3.0 + 0.25 * i, 0.3 * normal(random), 0.3 * normal(random));
      tile.add(place, basis.gradients(place) * weights + kNoise_T * normal3(), kNoise);
    }
    for (const Vec3& place : {Vec3(0.1, 0.4, 0.2), Vec3(-1.5, 1.5, 0.0), Vec3(1.8, -0.2, -1.8)}) {
      const PredictedField predicted = tile.predict(place);
      const Vec3 error = predicted.field - basis.gradients(place) * weights;
      nees += error.dot(predicted.covariance.llt().solve(error));
      ++count;
    }
  }
  // The mean of 180 draws of three squares.
  EXPECT_NEAR(nees / count, 3.0, 0.7);
}

/// Mean error per axis (T) and normalized squared error per degree of freedom.
struct MapErrors {
  double rms_T = 0.0, anomaly_rms_T = 0.0, nees = 0.0;
};

/// Errors of maps of three hulls on a path that swings beside the learnt one.
MapErrors errorsBesidePath(double beside_m) {
  // What the basis functions leave of fields of near dipoles.
  constexpr double kFloor_T = 0.2e-6;
  const Mat3 floor = kFloor_T * kFloor_T * Mat3::Identity();
  MapErrors errors;
  int count = 0;
  for (const uint64_t seed : {1, 2, 3}) {
    const std::vector<MapDipole> dipoles = plates(seed);
    FieldMap map{FieldMapOptions()};
    for (const MapReading& r : passBy(dipoles, seed)) map.learn(r.place, r.anomaly, kNoise + floor, {});
    for (double x = -9.0; x <= 9.0; x += 0.37, ++count) {
      const Vec3 place(x, 0.5 * std::sin(0.8 * x) + beside_m * std::sin(3.0 * x), 0.3 * std::cos(0.5 * x));
      const auto predicted = map.predict(place);
      if (!predicted) {
        ADD_FAILURE() << "no tile at " << place.transpose();
        return errors;
      }
      const Vec3 truth = fieldOf(dipoles, place);
      const Vec3 error = predicted->anomaly.field - truth;
      errors.rms_T += error.squaredNorm() / 3.0;
      errors.anomaly_rms_T += truth.squaredNorm() / 3.0;
      errors.nees += error.dot((predicted->anomaly.covariance + floor).llt().solve(error)) / 3.0;
    }
  }
  errors.rms_T = std::sqrt(errors.rms_T / count);
  errors.anomaly_rms_T = std::sqrt(errors.anomaly_rms_T / count);
  errors.nees /= count;
  return errors;
}

TEST(FieldMap, PredictsTheFieldOfSteelOnThePathAndKnowsItsErrorBesideIt) {
  const MapErrors on = errorsBesidePath(0.0), beside = errorsBesidePath(0.4);
  RecordProperty("on_path_share", std::to_string(on.rms_T / on.anomaly_rms_T));
  RecordProperty("beside_share", std::to_string(beside.rms_T / beside.anomaly_rms_T));
  EXPECT_GT(on.anomaly_rms_T, 3e-6);
  EXPECT_LT(on.rms_T, 0.04 * on.anomaly_rms_T);
  EXPECT_LT(beside.rms_T, 0.2 * beside.anomaly_rms_T);
  for (const MapErrors& errors : {on, beside}) {
    EXPECT_GT(errors.nees, 0.2);
    EXPECT_LT(errors.nees, 2.0);
  }
}

TEST(FieldMap, DerivativeByPlaceAgreesWithNumericDifferentiation) {
  FieldMap map{FieldMapOptions()};
  for (const MapReading& r : passBy(plates(4), 5)) map.learn(r.place, r.anomaly, kNoise, {});
  const Vec3 place(0.7, 0.2, 0.3);
  constexpr double kStep_m = 1e-4;
  const Mat3 analytic = map.predict(place)->anomaly.by_place;
  for (int d = 0; d < 3; ++d) {
    const Vec3 step = kStep_m * Vec3::Unit(d);
    const Vec3 numeric =
        (map.predict(place + step)->anomaly.field - map.predict(place - step)->anomaly.field) /
        (2.0 * kStep_m);
    EXPECT_LT((numeric - analytic.col(d)).norm(), 1e-4 * analytic.norm());
  }
}

TEST(FieldMap, TilesAgreeAtTheirBorder) {
  FieldMap map{FieldMapOptions()};
  for (const MapReading& r : passBy(plates(6), 7)) map.learn(r.place, r.anomaly, kNoise, {});
  const double border_m = 1.25 * FieldMapOptions().length_scale_m;
  const Vec3 left(border_m - 1e-6, 0.5 * std::sin(0.8 * border_m), 0.0), right = left + Vec3(2e-6, 0.0, 0.0);
  const auto a = map.predict(left), b = map.predict(right);
  EXPECT_GT((a->anomaly.field - b->anomaly.field).norm(), 0.0);  // two tiles
  EXPECT_LT((a->anomaly.field - b->anomaly.field).norm(), 3.0 * std::sqrt(a->anomaly.covariance.trace()));
}

TEST(FieldMap, MemoryIsBoundedAndTheOldestTileGoesFirst) {
  FieldMapOptions options;
  options.max_tiles = 12;
  FieldMap map(options);
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(map.predict(Vec3::Zero()));
  for (double x = 0.0; x <= 60.0; x += 0.5) map.learn(Vec3(x, 0.0, 0.0), Vec3(1e-6, 0.0, 0.0), kNoise, {});
  EXPECT_EQ(map.tiles(), 12);
  EXPECT_TRUE(map.predict(Vec3(59.0, 0.0, 0.0)));
  EXPECT_FALSE(map.predict(Vec3(1.0, 0.0, 0.0)));
}

TEST(FieldMap, ForgetsAPlaceAndTakesNothingThatIsNoNumber) {
  FieldMap map{FieldMapOptions()};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  map.learn(Vec3(nan, 0.0, 0.0), Vec3::Zero(), kNoise, {});
  map.learn(Vec3::Zero(), Vec3(0.0, nan, 0.0), kNoise, {});
  EXPECT_TRUE(map.empty());
  EXPECT_FALSE(map.predict(Vec3(nan, 0.0, 0.0)));
  map.learn(Vec3::Zero(), Vec3(1e-6, 0.0, 0.0), kNoise, {});
  map.learn(Vec3(20.0, 0.0, 0.0), Vec3(1e-6, 0.0, 0.0), kNoise, {});
  map.forget(Vec3(0.5, 0.0, 0.0));
  EXPECT_FALSE(map.predict(Vec3::Zero()));
  EXPECT_TRUE(map.predict(Vec3(20.0, 0.0, 0.0)));
}

TEST(FieldMap, RemembersHowWellTheReadingsWerePlaced) {
  FieldMap map{FieldMapOptions()};
  map.learn(Vec3::Zero(), Vec3(1e-6, 0.0, 0.0), kNoise, {Time::fromNanoseconds(5), 1e-4, 0.01});
  map.learn(Vec3(1.5, 0.0, 0.0), Vec3(1e-6, 0.0, 0.0), kNoise, {Time::fromNanoseconds(9), 3e-4, 0.03});
  // A place that is known already.
  map.learn(Vec3(0.05, 0.0, 0.0), Vec3(1e-6, 0.0, 0.0), kNoise, {Time::fromNanoseconds(11), 9e-4, 0.09});
  const auto predicted = map.predict(Vec3(0.1, 0.0, 0.0));
  ASSERT_TRUE(predicted);
  EXPECT_NEAR(predicted->heading_variance_rad2, 2e-4, 1e-12);
  EXPECT_NEAR(predicted->position_variance_m2, 0.02, 1e-12);
  EXPECT_EQ(predicted->last_reading, Time::fromNanoseconds(9));
}

}  // namespace
}  // namespace lodeline

#include "lodeline/cameras/ports/refractive_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "lodeline/cameras/ports/test_ports.h"

namespace lodeline {
namespace {

using test::makeRefractive;
using test::PortCase;

/// Snell's law by the tangential components of unit directions: n_1 (d_1 x normal) = n_2 (d_2 x normal).
std::optional<Vec3> bent(const Vec3& d, const Vec3& normal, double from_index, double to_index) {
  const Vec3 tangential = from_index / to_index * (d - d.dot(normal) * normal);
  const double rest = 1.0 - tangential.squaredNorm();
  if (rest <= 0.0) return std::nullopt;
  return Vec3(tangential + std::sqrt(rest) * normal);
}

/// A light path from the lens, step by step: to a face, through it, to the next one. Independent of the
/// projection, which solves one equation in the plane of refraction.
struct TracedRay {
  Vec3 at = Vec3::Zero(), direction;

  bool crossPlane(const Vec3& normal, double distance_m, double from_index, double to_index) {
    if (direction.dot(normal) <= 0.0) return false;
    at += (distance_m - at.dot(normal)) / direction.dot(normal) * direction;
    return turn(normal, from_index, to_index);
  }
  bool crossSphere(const Vec3& centre, double radius_m, double from_index, double to_index) {
    // |at + s direction - centre| = radius, a quadratic equation in s.
    const double b = direction.dot(at - centre), c = (at - centre).squaredNorm() - radius_m * radius_m;
    at += (std::sqrt(b * b - c) - b) * direction;
    return turn((at - centre).normalized(), from_index, to_index);
  }
  bool turn(const Vec3& normal, double from_index, double to_index) {
    const auto next = bent(direction, normal, from_index, to_index);
    if (next) direction = next->normalized();
    return next.has_value();
  }
};

std::optional<TracedRay> traced(const Port& port, const Vec3& direction) {
  TracedRay ray{Vec3::Zero(), direction.normalized()};
  const double outer = port.thickness_m;
  const bool passes =
      port.type == Port::Type::Flat
          ? ray.crossPlane(port.normal_C, port.distance_m, port.index_air, port.index_glass) &&
                ray.crossPlane(port.normal_C, port.distance_m + outer, port.index_glass, port.index_water)
          : ray.crossSphere(port.centre_C, port.radius_m, port.index_air, port.index_glass) &&
                ray.crossSphere(port.centre_C, port.radius_m + outer, port.index_glass, port.index_water);
  return passes ? std::optional(ray) : std::nullopt;
}

class EveryPort : public testing::TestWithParam<PortCase> {
 protected:
  std::vector<Vec2> pixels(int step_px) const {
    std::vector<Vec2> grid;
    for (int x = 0; x < calibration_.width_px; x += step_px) {
      for (int y = 0; y < calibration_.height_px; y += step_px) grid.emplace_back(x, y);
    }
    grid.emplace_back(calibration_.cx_px, calibration_.cy_px);
    return grid;
  }
  /// Points on the traced rays of pixels, near and far.
  std::vector<Vec3> points(int step_px) const {
    std::vector<Vec3> points;
    for (const Vec2& pixel : pixels(step_px)) {
      const auto ray = traced(*calibration_.port, *lens_->unproject(pixel));
      if (!ray) continue;
      for (const double length_m : {0.3, 1.7, 20.0}) points.push_back(ray->at + length_m * ray->direction);
    }
    return points;
  }
  CameraCalibration lensAlone() const {
    CameraCalibration lens = calibration_;
    lens.port.reset();
    return lens;
  }

  CameraCalibration calibration_ = GetParam().calibration;
  std::shared_ptr<const RefractiveCamera> camera_ = makeRefractive(calibration_);
  std::shared_ptr<const Camera> lens_ = makeCamera(lensAlone());
};
INSTANTIATE_TEST_SUITE_P(Ports, EveryPort, testing::ValuesIn(test::portCases()), test::portCaseName);

TEST_P(EveryPort, ProjectsPointsOfTracedRaysToTheirPixels) {
  int compared = 0;
  for (const Vec2& pixel : pixels(25)) {
    const auto ray = traced(*calibration_.port, *lens_->unproject(pixel));
    if (!ray) continue;
    for (const double length_m : {1e-3, 0.3, 1.0, 3.0, 20.0}) {
      const auto back = camera_->project(ray->at + length_m * ray->direction, nullptr, nullptr);
      ASSERT_TRUE(back) << pixel.transpose();
      EXPECT_LT((*back - pixel).norm(), 1e-9) << pixel.transpose() << " at " << length_m;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1500);
}

TEST_P(EveryPort, GivesTheLineOfAPixel) {
  for (const Vec2& pixel : pixels(60)) {
    const auto expected = traced(*calibration_.port, *lens_->unproject(pixel));
    const auto ray = camera_->viewRay(pixel);
    ASSERT_EQ(ray.has_value(), expected.has_value());
    if (!ray) continue;
    EXPECT_LT((ray->origin_C - expected->at).norm(), 1e-14);
    EXPECT_LT((ray->direction_C - expected->direction).norm(), 1e-13);
    const Vec3 nominal_C = *camera_->unproject(pixel);
    EXPECT_NEAR(nominal_C.norm(), 1.0, 1e-14);
    EXPECT_LT((nominal_C - ray->origin_C).cross(ray->direction_C).norm(), 1e-13) << "at one metre";
  }
}

TEST_P(EveryPort, HasTheDerivativeByThePoint) {
  constexpr double kStep = 2e-5;
  for (const Vec3& point_C : points(90)) {
    Mat23 analytic, numeric;
    ASSERT_TRUE(camera_->project(point_C, &analytic, nullptr));
    const auto at = [&](int i, double step) {
      return *camera_->project(point_C + step * Vec3::Unit(i), nullptr, nullptr);
    };
    for (int i = 0; i < 3; ++i) {
      numeric.col(i) =
          (8.0 * (at(i, kStep) - at(i, -kStep)) - (at(i, 2 * kStep) - at(i, -2 * kStep))) / (12.0 * kStep);
    }
    EXPECT_LT((analytic - numeric).norm(), 1e-6 * numeric.norm() + 1e-6) << point_C.transpose();
  }
}

TEST_P(EveryPort, HasTheDerivativeByThePort) {
  const Eigen::Index count = calibration_.port->type == Port::Type::Flat ? 7 : 8;
  for (Eigen::Index k = 0; k < count; ++k) {
    constexpr double kStep = 2e-6;
    std::vector<std::shared_ptr<const RefractiveCamera>> moved;
    for (const double change : {-kStep, kStep}) {
      CameraCalibration c = calibration_;
      c.port = test::movedPort(*calibration_.port, k, change);
      // The index of air is next to its limit, which the derivative does not know.
      if (k == count - 3) c.port->index_air += 1e-5;
      moved.push_back(makeRefractive(c));
    }
    CameraCalibration base = calibration_;
    if (k == count - 3) base.port->index_air += 1e-5;
    const auto camera = makeRefractive(base);
    for (const Vec3& point_C : points(120)) {
      PixelByPort analytic;
      const auto less = moved[0]->project(point_C, nullptr, nullptr),
                 more = moved[1]->project(point_C, nullptr, nullptr);
      if (!less || !more || !camera->projectByPort(point_C, &analytic)) continue;
      ASSERT_EQ(analytic.cols(), count);
      const Vec2 numeric = (*more - *less) / (2.0 * kStep);
      EXPECT_LT((analytic.col(k) - numeric).norm(), 2e-6 * numeric.norm() + 2e-4)
          << "parameter " << k << ": " << point_C.transpose();
    }
  }
}

TEST_P(EveryPort, HasTheDerivativesOfTheLensByItsParameters) {
  for (const Vec3& point_C : points(120)) {
    Mat23 by_point;
    PixelByParameters by_parameters, of_the_lens;
    const auto pixel = camera_->project(point_C, &by_point, &by_parameters);
    ASSERT_TRUE(pixel);
    lens_->project(*lens_->unproject(*pixel), nullptr, &of_the_lens);
    EXPECT_LT((by_parameters - of_the_lens).norm(), 1e-8 * of_the_lens.norm());
    EXPECT_EQ(*pixel, *camera_->project(point_C, nullptr, nullptr)) << "derivatives change nothing";
  }
}

TEST_P(EveryPort, IsTheLensWhereAllIndicesAreEqual) {
  CameraCalibration same = calibration_;
  same.port->index_air = same.port->index_glass = same.port->index_water = 1.333;
  const auto camera = makeRefractive(same);
  for (const Vec3& point_C : points(60)) {
    const auto pixel = camera->project(point_C, nullptr, nullptr), expected = lens_->project(point_C);
    ASSERT_EQ(pixel.has_value(), expected.has_value());
    if (pixel) {
      EXPECT_LT((*pixel - *expected).norm(), 1e-9);
    }
  }
}

TEST_P(EveryPort, GivesNothingForWhatNoLightReaches) {
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  for (const Vec3& point_C :
       {Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.01), Vec3(0.001, 0.0, 0.0), Vec3(nan, 0.0, 1.0),
        Vec3(0.0, 0.0, nan), Vec3(infinity, 0.0, 1.0), Vec3(0.0, 0.0, -1.0), Vec3(0.1, 0.1, -2.0)}) {
    Mat23 by_point;
    EXPECT_FALSE(camera_->project(point_C, &by_point, nullptr)) << point_C.transpose();
  }
  for (double angle = 0.0; angle < 3.2; angle += 0.01) {
    const auto pixel = camera_->project(3.0 * Vec3(std::sin(angle), 0.0, std::cos(angle)), nullptr, nullptr);
    if (pixel) {
      EXPECT_TRUE(pixel->allFinite());
    }
  }
  for (const Vec2& pixel : {Vec2(nan, 0.0), Vec2(infinity, 0.0), Vec2(-1e20, 1e20)}) {
    EXPECT_FALSE(camera_->unproject(pixel));
    EXPECT_FALSE(camera_->viewRay(pixel));
  }
}

TEST_P(EveryPort, IsValidUpToItsLargestAngle) {
  const double end_rad = camera_->maxAngle_rad();
  EXPECT_GT(end_rad, 0.5);
  for (double around = 0.0; around < 6.28; around += 0.2) {
    const double angle = end_rad - 1e-6;
    EXPECT_TRUE(camera_->project(
        Vec3(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle)),
        nullptr, nullptr));
  }
}

TEST_P(EveryPort, SeesPointsAtInfinityAsVeryFarOnes) {
  for (const Vec3& point_C : points(120)) {
    const auto at_infinity = camera_->projectHomogeneous(point_C, 0.0);
    const auto far = camera_->project(1e6 / point_C.norm() * point_C, nullptr, nullptr);
    ASSERT_EQ(at_infinity.has_value(), far.has_value());
    if (far) {
      EXPECT_LT((*at_infinity - *far).norm(), 1e-3);
    }
    const auto scaled = camera_->projectHomogeneous(0.25 * point_C, 0.25);
    EXPECT_LT((*scaled - *camera_->project(point_C, nullptr, nullptr)).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace lodeline

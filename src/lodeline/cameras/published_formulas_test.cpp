// Pixels of the fisheye models against the formulas of their publications, written independently in angles.

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/cameras/test_camera_models.h"

namespace lodeline {
namespace {

constexpr double kFu_px = 310.0, kFv_px = 305.0, kCu_px = 366.0, kCv_px = 251.0;

CameraCalibration cameraOf(const char* model, std::vector<double> parameters) {
  CameraCalibration c = test::typicalCamera(*findCameraModel(model), parameters.size());
  c.fx_px = kFu_px;
  c.fy_px = kFv_px;
  c.cx_px = kCu_px;
  c.cy_px = kCv_px;
  c.distortion = std::move(parameters);
  return c;
}

/// Compares the pixels of rays with those of an image radius as a function of the angle to the axis. Goes up
/// to the largest angle of the camera and expects it to be at least `least_rad`.
template <typename RadiusAt>
void expectRadius(const CameraCalibration& calibration, double least_rad, const RadiusAt& radiusAt) {
  const auto camera = makeCamera(calibration);
  ASSERT_GE(camera->maxAngle_rad(), least_rad);
  for (double theta = 0.01; theta < camera->maxAngle_rad(); theta += 0.03) {
    for (double phi = -3.0; phi < 3.1; phi += 0.5) {
      const double range_m = 0.7 + theta;
      const Vec3 point_C =
          range_m * Vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
      const double radius = radiusAt(theta), tolerance_px = 1e-10 * (1.0 + kFu_px * radius);
      const auto pixel = camera->project(point_C);
      ASSERT_TRUE(pixel) << theta;
      EXPECT_NEAR(pixel->x(), kFu_px * radius * std::cos(phi) + kCu_px, tolerance_px) << theta;
      EXPECT_NEAR(pixel->y(), kFv_px * radius * std::sin(phi) + kCv_px, tolerance_px) << theta;
    }
  }
}

// Usenko et al. 2018: the ray meets a unit sphere, then one whose centre is xi behind it; the plane is
// alpha / (1 - alpha) behind the second centre.
TEST(PublishedFormulas, DoubleSphere) {
  for (const auto& [xi, alpha] : {std::pair(-0.2, 0.6), std::pair(0.3, 0.55), std::pair(0.1, 0.3)}) {
    expectRadius(cameraOf("double-sphere", {xi, alpha}), 1.5, [xi = xi, alpha = alpha](double theta) {
      const double second = std::atan2(std::sin(theta), std::cos(theta) + xi);
      const double shift = alpha / (1.0 - alpha);
      return std::sin(second) / (std::cos(second) + shift) / (1.0 - alpha);
    });
  }
}

// Mei and Rives 2007: the unit sphere seen from xi behind its centre, then Brown's distortion (radial here).
TEST(PublishedFormulas, Unified) {
  for (const double xi : {0.0, 0.7, 1.0, 1.8}) {
    const double k1 = -0.02, k2 = 0.01;
    expectRadius(cameraOf("unified", {xi, k1, k2, 0.0, 0.0}), 1.3, [=](double theta) {
      const double m = std::sin(theta) / (std::cos(theta) + xi);
      return m + k1 * std::pow(m, 3) + k2 * std::pow(m, 5);
    });
  }
}

// The tangential part, in the form of Mei's equation 8 (as OpenCV's, with p1 for y).
TEST(PublishedFormulas, UnifiedWithTangentialDistortion) {
  const double xi = 1.1, p1 = 3e-3, p2 = -2e-3;
  const auto camera = makeCamera(cameraOf("unified", {xi, 0.0, 0.0, p1, p2}));
  const Vec3 ray = Vec3(0.5, -0.3, 0.8).normalized();
  const double x = ray.x() / (ray.z() + xi), y = ray.y() / (ray.z() + xi), r2 = x * x + y * y;
  const Vec2 expected(kFu_px * (x + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + kCu_px,
                      kFv_px * (y + 2.0 * p2 * x * y + p1 * (r2 + 2.0 * y * y)) + kCv_px);
  EXPECT_LT((*camera->project(3.0 * ray) - expected).norm(), 1e-9);
}

// Khomutenko et al. 2016: projection by the surface alpha sqrt(beta r^2 + z^2) + (1 - alpha) z = 1.
TEST(PublishedFormulas, ExtendedUnified) {
  for (const auto& [alpha, beta] : {std::pair(0.6, 1.1), std::pair(0.5, 0.8), std::pair(0.2, 1.4)}) {
    expectRadius(cameraOf("extended-unified", {alpha, beta}), 1.5,
                 [alpha = alpha, beta = beta](double theta) {
                   const double s = std::sin(theta), c = std::cos(theta);
                   return s / (alpha * std::sqrt(beta * s * s + c * c) + (1.0 - alpha) * c);
                 });
  }
}

// With beta = 1 the model is the unified one with xi = alpha / (1 - alpha) and longer focal lengths.
TEST(PublishedFormulas, ExtendedUnifiedContainsUnified) {
  const double alpha = 0.58, xi = alpha / (1.0 - alpha);
  CameraCalibration unified = cameraOf("unified", {xi});
  unified.fx_px /= 1.0 - alpha;
  unified.fy_px /= 1.0 - alpha;
  const auto one = makeCamera(unified), other = makeCamera(cameraOf("extended-unified", {alpha, 1.0}));
  for (double x = -3.0; x <= 3.0; x += 0.25) {
    EXPECT_LT((*one->project(Vec3(x, 0.5, 0.2)) - *other->project(Vec3(x, 0.5, 0.2))).norm(), 1e-9);
  }
}

// Devernay and Faugeras 2001, equation 13: r_d = atan(2 r_u tan(w / 2)) / w.
TEST(PublishedFormulas, FieldOfView) {
  for (const double w : {0.4, 0.93, 2.0}) {
    expectRadius(cameraOf("field-of-view", {w}), 1.57, [w](double theta) {
      const double half = std::tan(0.5 * w);
      // The continuous branch of the arc tangent beyond 90 degrees.
      return (0.5 * M_PI - std::atan(std::cos(theta) / (2.0 * half * std::sin(theta)))) / w;
    });
  }
}

// Ends that follow from the geometry: where the pixel becomes infinite, or where a ray is tangent to the
// sphere.
TEST(PublishedFormulas, LargestAngles) {
  const auto end = [](const char* model, std::vector<double> parameters) {
    return makeCamera(cameraOf(model, std::move(parameters)))->maxAngle_rad();
  };
  constexpr double kMargin_rad = 2e-3;
  EXPECT_NEAR(end("double-sphere", {0.0, 0.0}), 0.5 * M_PI, kMargin_rad) << "a pinhole camera";
  EXPECT_NEAR(end("double-sphere", {-0.3, 0.0}), std::acos(0.3), kMargin_rad);
  EXPECT_NEAR(end("double-sphere", {0.3, 0.0}), std::acos(-0.3), kMargin_rad);
  EXPECT_NEAR(end("extended-unified", {0.0, 1.0}), 0.5 * M_PI, kMargin_rad) << "a pinhole camera";
  EXPECT_NEAR(end("extended-unified", {1.0, 1.0}), 0.5 * M_PI, kMargin_rad) << "an orthographic camera";
  EXPECT_NEAR(end("unified", {0.2}), std::acos(-0.2), 1e-2) << "the plane of the distortion is finite";
  EXPECT_NEAR(end("unified", {4.0}), std::acos(-0.25), kMargin_rad);
  EXPECT_NEAR(end("unified", {1.0}), 115.0 * M_PI / 180.0, 1e-12) << "no lens is wider";
}

}  // namespace
}  // namespace lodeline

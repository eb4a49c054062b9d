// Tests of every registered camera model.

#include "lodeline/cameras/camera_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "lodeline/cameras/test_camera_models.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

Vec3 rayAt(double angle_rad, double around_rad) {
  return Vec3(std::sin(angle_rad) * std::cos(around_rad), std::sin(angle_rad) * std::sin(around_rad),
              std::cos(angle_rad));
}

class EveryCameraModel : public testing::TestWithParam<CameraCalibration> {
 protected:
  /// Rays up to a share of the largest angle, in all directions, and two rays close to the axis.
  std::vector<Vec3> rays(double share) const {
    std::vector<Vec3> rays = {Vec3::UnitZ(), Vec3(5e-7, -1e-6, 1.0).normalized()};
    for (double part = 0.02; part <= share; part += 0.02) {
      for (double around_rad = 0.1; around_rad < 6.28; around_rad += 0.45)
        rays.push_back(rayAt(part * camera_->maxAngle_rad(), around_rad));
    }
    return rays;
  }

  CameraCalibration calibration_ = GetParam();
  std::shared_ptr<const Camera> camera_ = makeCamera(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Registered, EveryCameraModel, testing::ValuesIn(test::typicalCameras()),
                         test::testName);

TEST_P(EveryCameraModel, ReturnsFromPixelToRayToPixelOverTheWholeImage) {
  int seen = 0;
  for (int x = 0; x < calibration_.width_px; x += 15) {
    for (int y = 0; y < calibration_.height_px; y += 15) {
      const auto ray = camera_->unproject(Vec2(x, y));
      if (!ray) continue;
      ++seen;
      EXPECT_NEAR(ray->norm(), 1.0, 1e-14);
      const auto back = camera_->project(4.2 * *ray);
      ASSERT_TRUE(back) << x << ", " << y;
      EXPECT_LT((*back - Vec2(x, y)).norm(), 1e-8) << x << ", " << y;
    }
  }
  EXPECT_EQ(seen, 51 * 32) << "a typical lens has a ray for every pixel";
}

TEST_P(EveryCameraModel, ReturnsFromRayToPixelToRay) {
  for (const Vec3& ray : rays(0.9999)) {
    const auto pixel = camera_->project(ray);
    ASSERT_TRUE(pixel) << ray.transpose();
    const auto back = camera_->unproject(*pixel);
    ASSERT_TRUE(back) << ray.transpose();
    EXPECT_LT((*back - ray).norm(), 1e-10) << ray.transpose();
  }
}

TEST_P(EveryCameraModel, HasTheDerivativeByThePoint) {
  constexpr double kStep = 1e-4;
  for (const Vec3& ray : rays(0.97)) {
    const Vec3 point_C = 3.7 * ray;
    Mat23 analytic, numeric;
    ASSERT_TRUE(camera_->project(point_C, &analytic));
    for (int i = 0; i < 3; ++i) {
      const Vec3 d = kStep * Vec3::Unit(i);
      numeric.col(i) = (8.0 * (*camera_->project(point_C + d) - *camera_->project(point_C - d)) -
                        (*camera_->project(point_C + 2 * d) - *camera_->project(point_C - 2 * d))) /
                       (12.0 * kStep);
    }
    EXPECT_LT((analytic - numeric).norm(), 1e-7 * numeric.norm()) << ray.transpose();
    EXPECT_LT((analytic * point_C).norm(), 1e-9 * analytic.norm())
        << "the pixel depends on the direction only";
  }
}

TEST_P(EveryCameraModel, HasTheDerivativeByTheParameters) {
  const auto with = [this](Eigen::Index k, double change) {
    CameraCalibration c = calibration_;
    double* values[] = {&c.fx_px, &c.fy_px, &c.cx_px, &c.cy_px};
    (k < 4 ? *values[k] : c.distortion[static_cast<size_t>(k) - 4]) += change;
    return makeCamera(c);
  };
  const auto count = 4 + static_cast<Eigen::Index>(calibration_.distortion.size());
  for (Eigen::Index k = 0; k < count; ++k) {
    const double step = k < 4 ? 1e-2 : 1e-5;
    const auto less2 = with(k, -2.0 * step), less = with(k, -step), more = with(k, step);
    const auto more2 = with(k, 2.0 * step);
    int compared = 0;
    for (const Vec3& ray : rays(0.97)) {
      PixelByParameters analytic;
      const auto pixel = camera_->project(2.5 * ray, nullptr, &analytic);
      ASSERT_EQ(analytic.cols(), count);
      if (!camera_->contains(*pixel)) continue;
      ++compared;
      const Vec2 numeric = (8.0 * (*more->project(ray) - *less->project(ray)) -
                            (*more2->project(ray) - *less2->project(ray))) /
                           (12.0 * step);
      EXPECT_LT((analytic.col(k) - numeric).norm(), 1e-7 * numeric.norm() + 1e-7)
          << k << ": " << ray.transpose();
    }
    EXPECT_GT(compared, 100);
  }
}

TEST_P(EveryCameraModel, GivesBothDerivativesTogetherAsAlone) {
  const Vec3 point_C(0.4, -0.7, 1.9);
  Mat23 by_point, by_point_alone;
  PixelByParameters by_parameters, by_parameters_alone;
  const auto pixel = camera_->project(point_C, &by_point, &by_parameters);
  EXPECT_EQ(*pixel, *camera_->project(point_C));
  camera_->project(point_C, &by_point_alone);
  camera_->project(point_C, nullptr, &by_parameters_alone);
  EXPECT_EQ(by_point, by_point_alone);
  EXPECT_EQ(by_parameters, by_parameters_alone);
}

TEST_P(EveryCameraModel, EndsAtItsLargestAngle) {
  const double end_rad = camera_->maxAngle_rad();
  ASSERT_GT(end_rad, 0.6);
  for (double around_rad = 0.0; around_rad < 6.28; around_rad += 0.3) {
    EXPECT_TRUE(camera_->project(rayAt(end_rad - 1e-6, around_rad)));
    EXPECT_FALSE(camera_->project(rayAt(end_rad + 1e-6, around_rad)));
    for (double beyond_rad = end_rad + 0.01; beyond_rad < 3.1415; beyond_rad += 0.05)
      EXPECT_FALSE(camera_->project(5.0 * rayAt(beyond_rad, around_rad))) << beyond_rad;
  }
}

TEST_P(EveryCameraModel, MovesThePixelOutwardsUpToItsLargestAngle) {
  const Vec2 centre(calibration_.cx_px, calibration_.cy_px);
  for (double around_rad = 0.0; around_rad < 6.28; around_rad += 0.3) {
    double before_px = 0.0;
    for (double part = 0.01; part < 1.0; part += 0.01) {
      const Vec3 ray = rayAt(part * camera_->maxAngle_rad(), around_rad);
      const double radius_px = (*camera_->project(ray) - centre).norm();
      EXPECT_GT(radius_px, before_px) << part;
      before_px = radius_px;
    }
  }
}

TEST_P(EveryCameraModel, GivesNothingForDegenerateInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(camera_->project(Vec3::Zero()));
  EXPECT_FALSE(camera_->project(Vec3(0.1, 0.1, -1.0)));
  EXPECT_FALSE(camera_->project(Vec3(0.0, 0.0, -1.0)));
  EXPECT_FALSE(camera_->project(Vec3(nan, 0.0, 1.0)));
  EXPECT_FALSE(camera_->project(Vec3(0.0, 0.0, nan)));
  EXPECT_FALSE(camera_->unproject(Vec2(nan, 0.0)));
  EXPECT_FALSE(camera_->unproject(Vec2(infinity, 0.0)));
  EXPECT_FALSE(camera_->unproject(Vec2(-1e20, 1e20)));
}

TEST_P(EveryCameraModel, HasItsCentreAndFocalLengthsOnTheAxis) {
  EXPECT_LT((*camera_->project(Vec3::UnitZ()) - Vec2(calibration_.cx_px, calibration_.cy_px)).norm(), 1e-12);
  EXPECT_EQ(*camera_->unproject(Vec2(calibration_.cx_px, calibration_.cy_px)), Vec3::UnitZ());
  constexpr double kSmall_rad = 1e-6;
  const Vec2 aside = *camera_->project(Vec3(kSmall_rad, kSmall_rad, 1.0));
  const Vec2 slopes_px = (aside - Vec2(calibration_.cx_px, calibration_.cy_px)) / kSmall_rad;
  EXPECT_LT((slopes_px - camera_->focalLengthsOnAxis_px()).norm(), 1e-2);
  EXPECT_EQ(focalLengthOnAxis_px(calibration_), camera_->focalLengthsOnAxis_px().x());
}

std::string refusal(const CameraCalibration& calibration) {
  try {
    makeCamera(calibration);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_P(EveryCameraModel, RefusesWhatIsNoParameter) {
  CameraCalibration longer = calibration_;
  longer.distortion.resize(40, 0.1);
  EXPECT_THAT(refusal(longer), testing::HasSubstr("40"));
  const CameraModel& model = camera_->model();
  for (size_t k = 0; k < calibration_.distortion.size(); ++k) {
    CameraCalibration undefined = calibration_;
    undefined.distortion[k] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(refusal(undefined), testing::HasSubstr("nan"));
    CameraCalibration large = calibration_;
    large.distortion[k] = -1e3;
    const std::string fault = model.fault ? model.fault(large.distortion) : "";
    EXPECT_EQ(refusal(large), fault.empty() ? "accepted" : "camera 'cam0': " + fault);
  }
  CameraCalibration flat = calibration_;
  flat.fx_px = 0.0;
  EXPECT_THAT(refusal(flat), testing::HasSubstr("focal length 0"));
}

TEST(CameraModels, AreFoundByEveryNameAndOnlyOnce) {
  std::set<std::string_view> names;
  std::set<std::pair<std::string_view, std::string_view>> pairs;
  for (const CameraModel& model : cameraModels()) {
    EXPECT_TRUE(names.insert(model.name).second) << model.name;
    EXPECT_EQ(findCameraModel(model.name), &model);
    for (const std::string_view alias : model.aliases) {
      EXPECT_TRUE(names.insert(alias).second) << alias;
      EXPECT_EQ(findCameraModel(alias), &model) << alias;
    }
    for (const std::string_view projection : model.projections) {
      for (const std::string_view distortion : model.distortions) {
        EXPECT_TRUE(pairs.emplace(projection, distortion).second) << projection << " " << distortion;
        EXPECT_EQ(findCameraModel(projection, distortion), &model) << projection << " " << distortion;
      }
    }
  }
  EXPECT_EQ(findCameraModel("scaramuzza"), nullptr);
  EXPECT_EQ(findCameraModel("ds", "equidistant"), nullptr);
}

TEST(CameraModels, DescribeThemselvesConsistently) {
  for (const CameraModel& model : cameraModels()) {
    ASSERT_FALSE(model.counts.empty()) << model.name;
    EXPECT_EQ(model.counts.back(), model.parameters.size()) << model.name;
    EXPECT_LE(model.before_focal_lengths, model.counts.front()) << model.name;
    EXPECT_LE(model.typical.parameters.size(), model.parameters.size()) << model.name;
    if (model.radial_model.empty()) continue;
    const CameraModel* radial = findCameraModel(model.radial_model);
    ASSERT_NE(radial, nullptr) << model.name;
    EXPECT_EQ(radial->plane, model.plane) << model.name;
    EXPECT_GE(radial->counts.front(), 2u) << model.name;
  }
}

TEST(CameraModels, NameTheValueThatIsWrong) {
  const auto with = [](const char* model, std::vector<double> parameters) {
    CameraCalibration c = test::typicalCamera(*findCameraModel("none"), 0);
    c.model = model;
    c.distortion = std::move(parameters);
    return c;
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal(with("double-sphere", {1.2, 0.5})), HasSubstr("xi of the double-sphere model is 1.2"));
  EXPECT_THAT(refusal(with("double-sphere", {-0.2, 1.5})),
              HasSubstr("alpha of the double-sphere model is 1.5"));
  EXPECT_THAT(refusal(with("extended-unified", {-0.1, 1.0})), HasSubstr("alpha of the extended-unified"));
  EXPECT_THAT(refusal(with("extended-unified", {0.6, 0.0})), HasSubstr("beta of the extended-unified"));
  EXPECT_THAT(refusal(with("unified", {-0.4})), HasSubstr("xi of the unified model is -0.4"));
  EXPECT_THAT(refusal(with("field-of-view", {0.0})), HasSubstr("w of the field-of-view model is 0"));
  EXPECT_THAT(refusal(with("field-of-view", {3.2})), HasSubstr("3.2"));
  EXPECT_THAT(refusal(with("unified", {1.0, 0.1})),
              HasSubstr("takes 1 or 5 parameters (xi, k1, k2, p1, p2)"));
}

}  // namespace
}  // namespace lodeline

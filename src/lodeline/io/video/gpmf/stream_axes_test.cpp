#include "lodeline/io/video/gpmf/stream_axes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

namespace lodeline::gpmf {
namespace {

using ::testing::HasSubstr;

const Vec3 kStored(1, 2, 3);

Vec3 inBody(const Stream& stream) { return axesOf(stream).body_from_stored * kStored; }

Stream stated(const std::string& letters) {
  Stream stream;
  stream.stored_axes = letters;
  return stream;
}

Mat3 rows(double a, double b, double c, double d, double e, double f, double g, double h, double i) {
  Mat3 matrix;
  matrix << a, b, c, d, e, f, g, h, i;
  return matrix;
}

TEST(StreamAxes, FollowsTheLettersOfTheStream) {
  EXPECT_EQ(inBody(stated("ZXY")), Vec3(2, 3, 1));    // HERO5
  EXPECT_EQ(inBody(stated("YxZ")), Vec3(-2, 1, 3));   // HERO6, HERO7
  EXPECT_EQ(inBody(stated("zxY")), Vec3(-2, 3, -1));  // HERO8
  EXPECT_EQ(inBody(stated("yXZ")), Vec3(2, -1, 3));   // Fusion
}

TEST(StreamAxes, IsAlwaysARotation) {
  int valid = 0;
  for (const char a : {'x', 'X', 'y', 'Y', 'z', 'Z'}) {
    for (const char b : {'x', 'X', 'y', 'Y', 'z', 'Z'}) {
      for (const char c : {'x', 'X', 'y', 'Y', 'z', 'Z'}) {
        const std::optional<Mat3> axes = fromLetters({a, b, c});
        if (!axes) continue;
        ++valid;
        EXPECT_NEAR(axes->determinant(), 1.0, 1e-12);
      }
    }
  }
  EXPECT_EQ(valid, 24);
}

TEST(StreamAxes, RefusesLettersThatAreNoRightHandedOrder) {
  for (const char* wrong : {"XYz", "XXY", "XY", "ABC", "XYZW"}) {
    EXPECT_FALSE(fromLetters(wrong)) << wrong;
    const StreamAxes axes = axesOf(stated(wrong));
    EXPECT_THAT(axes.problem, HasSubstr("ORIN")) << wrong;
  }
}

TEST(StreamAxes, TakesAMatrixWithTheOrderOfItsOutput) {
  Stream stream;
  stream.output_axes = "ZXY";
  stream.matrix = rows(0, 0, 1, 0, -1, 0, 1, 0, 0);  // of YxZ
  EXPECT_EQ(inBody(stream), Vec3(-2, 1, 3));
  EXPECT_EQ(inBody(stream), inBody(stated("YxZ")));
}

TEST(StreamAxes, TakesASlightlyTurnedMatrixAsCalibration) {
  Stream stream = stated("YxZ");
  stream.output_axes = "ZXY";
  stream.matrix = rows(0, 0.02, 1, 0.01, -1, 0.02, 1, 0.01, 0);
  const StreamAxes axes = axesOf(stream);
  EXPECT_EQ(axes.problem, "");
  EXPECT_NEAR((axes.body_from_stored * kStored - Vec3(-2, 1, 3)).norm(), 0.09, 0.05);
}

TEST(StreamAxes, ToldContradictionKeepsTheLetters) {
  Stream stream = stated("ZXY");
  stream.output_axes = "ZXY";
  stream.matrix = rows(0, 0, 1, 0, -1, 0, 1, 0, 0);
  EXPECT_THAT(axesOf(stream).problem, HasSubstr("contradicts"));
  EXPECT_EQ(inBody(stream), Vec3(2, 3, 1));
  stream.matrix = Mat3::Zero();
  EXPECT_THAT(axesOf(stream).problem, HasSubstr("no rotation"));
  stream.matrix = -Mat3::Identity();
  EXPECT_THAT(axesOf(stream).problem, HasSubstr("no rotation"));
}

TEST(StreamAxes, UsesNamesThenModels) {
  Stream stream;
  stream.name = "Gyroscope (z,x,y)";
  stream.device_name = "Hero6 Black";
  EXPECT_EQ(inBody(stream), Vec3(2, 3, 1));
  stream.name = "Accelerometer (up/down, right/left, forward/back)";
  EXPECT_EQ(inBody(stream), Vec3(2, 3, 1));
  stream.name = "Gyroscope";
  EXPECT_EQ(inBody(stream), Vec3(-2, 1, 3));
  EXPECT_TRUE(axesOf(stream).is_known);
  stream.device_name = "Camera";
  EXPECT_FALSE(axesOf(stream).is_known);
  EXPECT_EQ(inBody(stream), Vec3(2, 3, 1));
}

}  // namespace
}  // namespace lodeline::gpmf

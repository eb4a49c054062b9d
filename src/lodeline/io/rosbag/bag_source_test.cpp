#include "lodeline/io/rosbag/bag_source.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/test_bag.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRig = R"(
imu0: {gyroscope_noise_density: 1e-4, gyroscope_random_walk: 1e-5, accelerometer_noise_density: 1e-3,
       accelerometer_random_walk: 1e-4}
mag0: {topic: /mag, T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], magnetometer_noise_density: 1e-8}
pressure0: {T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], depth_noise_std: 0.01, water_density_kg_per_m3: 1025}
sonar0: {T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], range_noise_std: 0.05}
)";

constexpr const char* kCamera =
    "{{topic: {}, T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], resolution: [3, 2], intrinsics: [3, 3, 1, 1], "
    "distortion_model: none}}";

class BagSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::hasRosbag()) GTEST_SKIP() << test::kRosbagMissing;
    test::runRosbag(fmt::format("kinds '{}'", bag_.string()));
  }

  BagSource open(const std::string& rig_text, std::map<std::string, std::string> topics = {}) {
    test::writeContent(rig_, rig_text);
    BagOptions options;
    options.rig_files = {rig_};
    options.topics = std::move(topics);
    return BagSource(bag_, options, &diagnostics_);
  }

  cv::Mat image(const std::string& topic) {
    BagSource source =
        open(std::string(kRig) + "cam0: " + fmt::format(kCamera, topic), {{"sonar0", "/sonar"}});
    const std::optional<PendingImage> pending = source.nextImage(0);
    if (!pending) return {};
    LoadedImage loaded = pending->load();
    problem_ = loaded.problem;
    return loaded.image;
  }

  TestRecording place_;
  std::filesystem::path bag_ = place_.folder() / "kinds.bag";
  std::filesystem::path rig_ = place_.folder() / "kinds.rig.yaml";
  Diagnostics diagnostics_;
  std::string problem_;
};

TEST_F(BagSourceTest, TurnsMessagesIntoReadings) {
  BagSource source =
      open(std::string(kRig) + "cam0: " + fmt::format(kCamera, "/i/padded"), {{"sonar0", "sonar"}});
  const std::optional<ImuSample> imu = source.nextImu();
  ASSERT_TRUE(imu);
  EXPECT_EQ(imu->time.nanoseconds(), 1'000'000'000);
  EXPECT_EQ(imu->angular_velocity_B, Vec3(1, 2, 3));
  EXPECT_EQ(imu->specific_force_B, Vec3(4, 5, 6));
  EXPECT_FALSE(source.nextImu()) << "not a number";
  EXPECT_EQ(diagnostics_.count("bag_message"), 1);
  EXPECT_EQ(source.nextMagnetometer()->field_M, Vec3(2e-5, -1e-5, 4e-5));
  EXPECT_EQ(source.nextDepth()->depth_m, 7.25);
  const std::optional<SonarSample> first = source.nextSonar();
  const std::optional<SonarSample> second = source.nextSonar();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->range_m, 1.5);
  EXPECT_EQ(first->angle_rad, 0.5);
  EXPECT_EQ(second->range_m, 2.5);
  EXPECT_EQ(second->angle_rad, 1.0);
  EXPECT_EQ(second->time.nanoseconds(), 1'250'000'000);
  EXPECT_FALSE(source.nextSonar());
}

TEST_F(BagSourceTest, TakesARangeForASonarThatLooksAhead) {
  BagSource source =
      open(std::string(kRig) + "cam0: " + fmt::format(kCamera, "/i/padded"), {{"sonar0", "/altimeter"}});
  EXPECT_EQ(source.nextSonar()->range_m, 3.1);
  EXPECT_FALSE(source.nextSonar()) << "beyond the sensor's limits";
}

TEST_F(BagSourceTest, MakesEveryEncodingGrey) {
  // OpenCV's weights: 0.299 red, 0.587 green, 0.114 blue.
  EXPECT_EQ(image("/i/bgr8").at<uint8_t>(1, 2), 120);  // 0.114 * 10 + 0.587 * 100 + 0.299 * 200
  EXPECT_EQ(image("/i/rgb8").at<uint8_t>(1, 2), 84);   // 0.299 * 10 + 0.587 * 100 + 0.114 * 200
  for (const char* topic : {"/i/mono16", "/i/mono16_big"}) {
    const cv::Mat grey = image(topic);
    EXPECT_EQ(grey.at<uint8_t>(0, 2), 1) << topic;
    EXPECT_EQ(grey.at<uint8_t>(1, 0), 0x12) << topic;
    EXPECT_EQ(grey.at<uint8_t>(1, 2), 0xff) << topic;
  }
  const cv::Mat padded = image("/i/padded");
  EXPECT_EQ(padded.size(), cv::Size(3, 2));
  EXPECT_EQ(padded.at<uint8_t>(1, 0), 4);
  for (const char* topic : {"/i/bayer_rggb8", "/i/bayer_bggr8", "/i/bayer_grbg8", "/i/bayer_gbrg8"}) {
    // 0.299 * 200 + 0.587 * 100 + 0.114 * 50; a wrong colour order would give 117 or 88.
    EXPECT_NEAR(image(topic).at<uint8_t>(4, 4), 124, 1) << topic;
  }
}

TEST_F(BagSourceTest, SaysWhyAnImageCannotBeUsed) {
  EXPECT_TRUE(image("/i/short").empty());
  EXPECT_THAT(problem_, HasSubstr("5 bytes are too few for 3 x 2 px"));
  EXPECT_TRUE(image("/i/strange").empty());
  EXPECT_THAT(problem_, HasSubstr("encoding 'hsv' is not supported"));
}

TEST_F(BagSourceTest, CamerasThatAreLeftOutNeedNoTopic) {
  const std::string rig = std::string(kRig) + "cam0: " + fmt::format(kCamera, "/i/padded") +
                          "\ncam1: " + fmt::format(kCamera, "/none");
  test::writeContent(rig_, rig);
  BagOptions options;
  options.rig_files = {rig_};
  options.topics = {{"sonar0", "/sonar"}};
  try {
    BagSource(bag_, options, &diagnostics_);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no topic /none for cam1"));
    EXPECT_THAT(error.what(), HasSubstr("--set source.cameras"));
  }
  options.camera_indices = {0};
  BagSource source(bag_, options, &diagnostics_);
  EXPECT_EQ(source.rig().cameras.size(), 1u);
  EXPECT_TRUE(source.nextImage(0));
}

TEST_F(BagSourceTest, ADamagedHeaderCostsOneMessage) {
  // Sets the length of the frame name, which follows the sequence number and the stamp, to 2 GB.
  test::runRosbag(fmt::format("damaged '{}'", bag_.string()));
  BagSource source = open(std::string(kRig) + "cam0: " + fmt::format(kCamera, "/i/grey"));
  int images = 0, readings = 0;
  while (source.nextImage(0)) ++images;
  while (source.nextImu()) ++readings;
  EXPECT_EQ(images, 2);
  EXPECT_EQ(readings, 2);
  EXPECT_EQ(diagnostics_.count("bag_message"), 2);
}

TEST_F(BagSourceTest, SaysWhichTopicsThereAre) {
  const auto refusal = [&](const std::string& rig, std::map<std::string, std::string> topics) {
    try {
      open(rig, std::move(topics));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string rig = std::string(kRig) + "cam0: " + fmt::format(kCamera, "/i/padded");
  EXPECT_THAT(refusal(rig, {}), HasSubstr("2 topics could be sonar0 (/altimeter, /sonar"));
  EXPECT_THAT(refusal(rig, {{"imu0", "/imo"}}),
              HasSubstr("has no topic /imo for imu0; the bag has /altimeter"));
  EXPECT_THAT(refusal(rig, {{"imu0", "/mag"}}), HasSubstr("is of type sensor_msgs/MagneticField"));
  EXPECT_THAT(refusal(rig + "\ncam1: " + fmt::format(kCamera, "/i/bgr8") +
                          "\ncam2: {T_BS: [1,0,0,0, 0,1,0,0, "
                          "0,0,1,0, 0,0,0,1], resolution: [3, 2], intrinsics: [3, 3, 1, 1], "
                          "distortion_model: none}",
                      {{"sonar0", "/sonar"}}),
              HasSubstr("topics of images for 1 cameras; name them"));
  std::filesystem::remove(rig_);
  EXPECT_THROW(BagSource(bag_, {}, &diagnostics_), InputError);
}

}  // namespace
}  // namespace lodeline

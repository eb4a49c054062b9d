#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_reader.h"
#include "lodeline/io/video/gpmf/gpmf_payload.h"
#include "lodeline/io/video/gpmf/stream_axes.h"
#include "lodeline/io/video/video_source.h"
#include "lodeline/util/files/test_data.h"

// Files of cameras: a film of a HERO5 on a drone, and payloads. The expected counts are those of ffprobe and
// of the counters (TSMP) in the files.

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class VideoRealTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testData("gopro");
    if (!folder_) GTEST_SKIP() << missingTestData("gopro");
    if (!canReadFilms()) GTEST_SKIP() << "built without FFmpeg";
  }

  VideoSource openKarma() {
    VideoOptions options;
    options.needs_calibration = false;
    return VideoSource(*folder_ / "karma.mp4", options, &diagnostics_);
  }

  gpmf::Payload payload(const std::string& name) {
    std::ifstream stream(*folder_ / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    return gpmf::parsePayload({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  }

  /// Samples by key of the device that has the key first.
  static std::map<std::string, size_t> countsOf(const gpmf::Payload& payload) {
    std::map<std::string, size_t> counts;
    for (const gpmf::Stream& stream : payload.streams) counts.emplace(stream.key, stream.samples);
    return counts;
  }

  std::optional<std::filesystem::path> folder_;
  Diagnostics diagnostics_;
};

TEST_F(VideoRealTest, KarmaHasTheImagesOfItsContainer) {
  VideoSource source = openKarma();
  const FilmTrack& track = source.chapters().front().images;
  EXPECT_EQ(track.stated_count, 362);
  EXPECT_EQ(track.width_px, 854);
  EXPECT_EQ(track.height_px, 480);
  std::vector<double> times_s;
  size_t decoded = 0;
  while (const std::optional<PendingImage> image = source.nextImage(0)) {
    times_s.push_back(image->time.seconds());
    const LoadedImage loaded = image->load();
    if (loaded.image.cols == 854 && loaded.image.rows == 480) ++decoded;
  }
  ASSERT_EQ(times_s.size(), 362U);
  EXPECT_EQ(decoded, 362U);
  EXPECT_NEAR(times_s.front(), 0.0, 1e-9);
  EXPECT_NEAR(times_s.back(), 361 * 1001.0 / 30000.0, 1e-6);
  EXPECT_NEAR(source.rig().cameras[0].rate_hz, 29.97, 0.01);
}

TEST_F(VideoRealTest, KarmaHasTheReadingsOfItsCounters) {
  VideoSource source = openKarma();
  std::map<std::string, VideoStreamFacts> facts;
  for (const VideoStreamFacts& fact : source.sensors()->facts()) {
    if (fact.device == "Camera") facts[fact.key] = fact;
  }
  EXPECT_EQ(facts["GYRO"].samples, 4795U);
  EXPECT_EQ(facts["GYRO"].counted, 4795);
  EXPECT_EQ(facts["ACCL"].samples, 2397U);
  EXPECT_EQ(facts["ACCL"].counted, 2397);
  EXPECT_EQ(facts["GYRO"].packets, 13U);
  EXPECT_NEAR(facts["GYRO"].rate_hz, 4795 / 12.079, 1.5);
  EXPECT_NEAR(facts["ACCL"].rate_hz, 2397 / 12.079, 0.8);
  // The payloads begin at 0 and end at 12.079 s; samples are handed over within 30 ms.
  EXPECT_NEAR(facts["GYRO"].first_s, 0.0, 0.030);
  EXPECT_NEAR(facts["GYRO"].last_s, 12.079, 0.030);
  EXPECT_NEAR(facts["ACCL"].last_s, 12.079, 0.030);
  int readings = 0;
  Vec3 mean_B = Vec3::Zero();
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    mean_B += sample->specific_force_B;
    ++readings;
  }
  EXPECT_NEAR(readings, 4795, 12);  // those between the first and the last reading of the accelerometer
  EXPECT_NEAR((mean_B / readings).norm(), 9.8, 0.7);
  EXPECT_EQ(diagnostics_.count("telemetry_damaged"), 0);
  EXPECT_EQ(diagnostics_.count("telemetry_lost"), 0);
}

TEST_F(VideoRealTest, ReadsPayloadsOfThreeCameras) {
  const gpmf::Payload hero5 = payload("hero5.raw"), hero6 = payload("hero6.raw"),
                      karma = payload("karma.raw");
  for (const gpmf::Payload* parsed : {&hero5, &hero6, &karma}) EXPECT_THAT(parsed->problems, IsEmpty());
  std::map<std::string, size_t> counts = countsOf(hero5);
  EXPECT_EQ(counts["ACCL"], 199U);
  EXPECT_EQ(counts["GYRO"], 399U);
  EXPECT_EQ(counts["GPS5"], 18U);
  EXPECT_EQ(counts["ISOG"], 24U);
  counts = countsOf(hero6);
  EXPECT_EQ(counts["ACCL"], 204U);
  EXPECT_EQ(counts["GYRO"], 204U);
  EXPECT_EQ(counts["FACE"], 17U);  // in 15 elements
  EXPECT_EQ(counts["WRGB"], 30U);
  counts = countsOf(karma);
  EXPECT_EQ(counts["ACCL"], 196U);
  EXPECT_EQ(counts["GYRO"], 392U);
  EXPECT_EQ(counts["SIMU"], 4U);
  EXPECT_EQ(counts["ESCS"], 1U);
  EXPECT_EQ(counts.count("SCPR"), 0U);  // without samples
}

TEST_F(VideoRealTest, ScalesAndTurnsRealReadings) {
  for (const gpmf::Stream& stream : payload("hero5.raw").streams) {
    if (stream.key == "GPS5") {
      EXPECT_NEAR(stream.values[0], 33.1264969, 1e-7);
      EXPECT_NEAR(stream.values[1], -117.3273542, 1e-7);
    }
    if (stream.key != "ACCL") continue;
    EXPECT_NEAR(stream.values[0], 4084.0 / 418.0, 1e-12);
    const Vec3 first_B = gpmf::axesOf(stream).body_from_stored * Vec3(stream.values.data());
    EXPECT_NEAR(first_B.z(), 4084.0 / 418.0, 1e-12);  // up
    EXPECT_NEAR(first_B.x(), -76.0 / 418.0, 1e-12);
  }
}

}  // namespace
}  // namespace lodeline

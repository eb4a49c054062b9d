#include "lodeline/io/rosbag/film_topic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "lodeline/io/film/film_reader.h"
#include "lodeline/io/film/test_film.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

wire::Bytes message(int64_t stamp_ns, const std::string& format, std::span<const uint8_t> data) {
  wire::Writer writer;
  writer.put(uint32_t{7});
  writer.putTime(Time::fromNanoseconds(stamp_ns));
  writer.putText("cam0");
  writer.putText(format);
  writer.putSized(data);
  return writer.take();
}

/// The packets of a small film; empty where Debian's encoder is missing.
std::vector<std::vector<uint8_t>> packets(const std::string& encoder) {
  test::FilmFolder folder;
  test::TestFilm film;
  film.codec = encoder;
  const std::filesystem::path file = folder.path("film.ts");
  try {
    test::writeFilm(file, film);
  } catch (const std::exception&) {
    return {};
  }
  FilmTrackReader reader(file, 0);
  std::vector<std::vector<uint8_t>> result;
  while (std::optional<FilmPacket> packet = reader.next()) result.push_back(std::move(packet->bytes));
  return result;
}

class FilmTopicTest : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(FilmTopicTest, DecodesEveryMessage) {
  const auto& [encoder, format] = GetParam();
  const auto data = packets(encoder);
  if (data.empty()) GTEST_SKIP() << "no encoder " << encoder;
  ASSERT_EQ(data.size(), 30U);
  FilmTopic topic;
  for (size_t i = 0; i < data.size(); ++i) {
    const auto image = topic.next(message(static_cast<int64_t>(i), format, data[i]), "bag /image");
    ASSERT_TRUE(image);
    EXPECT_EQ(image->time.nanoseconds(), static_cast<int64_t>(i));
    const LoadedImage loaded = image->load();
    ASSERT_FALSE(loaded.image.empty()) << i << loaded.problem;
    EXPECT_NEAR(cv::mean(loaded.image)[0], test::greyOfImage(static_cast<int>(i)), 3.0) << i;
    EXPECT_EQ(image->stored().pixels.size(), loaded.image.size());
  }
}

TEST_P(FilmTopicTest, TellsImagesBeforeAKeyImage) {
  const auto& [encoder, format] = GetParam();
  const auto data = packets(encoder);
  if (data.empty()) GTEST_SKIP() << "no encoder " << encoder;
  FilmTopic topic;
  const auto image = topic.next(message(5, format, data[3]), "bag /image");
  EXPECT_TRUE(image->load().image.empty());
  EXPECT_THAT(image->load().problem, HasSubstr("bag /image at 5 ns: "));
  const auto key = topic.next(message(6, format, data[12]), "bag /image");
  EXPECT_FALSE(key->load().image.empty());
}

INSTANTIATE_TEST_SUITE_P(Codecs, FilmTopicTest,
                         testing::Values(std::pair("libx264", "h264"), std::pair("libx265", "H.265")));

TEST(FilmTopic, LeavesImageFilesAlone) {
  FilmTopic topic;
  EXPECT_FALSE(topic.next(message(1, "bgr8; jpeg compressed bgr8", {}), ""));
  EXPECT_EQ(filmCodec("png"), "");
  EXPECT_EQ(filmCodec("video/H264"), "h264");
}

TEST(FilmTopic, ThrowsForMessagesThatAreCutOff) {
  FilmTopic topic;
  const wire::Bytes whole = message(1, "h264", std::vector<uint8_t>{1, 2, 3});
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_THROW(topic.next({whole.data(), length}, ""), wire::Reader::CutOff) << length;
  }
}

TEST(FilmTopic, RepacksCompressedVideo) {
  wire::Writer writer;
  writer.putTime(Time::fromNanoseconds(42));
  writer.putText("cam0");
  writer.putSized(std::vector<uint8_t>{1, 2, 3});
  writer.putText("h265");
  const wire::Bytes image = compressedImageOfVideo(writer.take());
  wire::Reader reader(image);
  reader.take<uint32_t>();
  EXPECT_EQ(reader.takeTime().nanoseconds(), 42);
  EXPECT_EQ(reader.takeText(), "cam0");
  EXPECT_EQ(reader.takeText(), "h265");
  EXPECT_EQ(reader.takeSized().size(), 3U);
}

}  // namespace
}  // namespace lodeline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <thread>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/film/film_reader.h"
#include "lodeline/io/film/test_film.h"

namespace lodeline {
namespace {

using test::TestFilm;
using ::testing::HasSubstr;

class FilmTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!canReadFilms()) GTEST_SKIP() << "built without FFmpeg";
  }

  std::filesystem::path write(const TestFilm& film, const std::string& name = "film.mp4") {
    test::writeFilm(folder_.path(name), film);
    return folder_.path(name);
  }

  static std::vector<double> timesOf(const std::filesystem::path& file) {
    const int track = describeFilm(file).first(FilmTrack::Kind::Images)->index;
    FilmFrameTimes times(file, track);
    std::vector<double> result;
    while (const std::optional<Duration> time = times.next()) result.push_back(time->seconds());
    return result;
  }

  /// Number of the image that has this grey; -1 where it has none.
  static int numberOf(const LoadedImage& image) {
    if (image.image.empty()) return -1;
    return static_cast<int>(std::lround((cv::mean(image.image)[0] - 40.0) / 4.0));
  }

  static void cutOff(const std::filesystem::path& file, double share) {
    const auto size = static_cast<double>(std::filesystem::file_size(file));
    std::filesystem::resize_file(file, static_cast<uintmax_t>(size * share));
  }

  static std::string refusalOf(const std::filesystem::path& file) {
    try {
      describeFilm(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  test::FilmFolder folder_;
};

TEST_F(FilmTest, StatesWhatTheHeadersHold) {
  TestFilm film;
  film.telemetry = {{0.0, 0.5, {1, 2, 3}}, {0.5, 0.5, {4}}};
  film.turned_deg = 90.0;
  const FilmInfo info = describeFilm(write(film, "film.mov"));
  const FilmTrack* images = info.first(FilmTrack::Kind::Images);
  ASSERT_NE(images, nullptr);
  EXPECT_EQ(images->codec, "mpeg4");
  EXPECT_EQ(images->width_px, 64);
  EXPECT_EQ(images->height_px, 48);
  EXPECT_EQ(images->stated_count, 30);
  EXPECT_NEAR(images->rate_hz, 30.0, 1e-6);
  EXPECT_NEAR(images->length.seconds(), 1.0, 1e-3);
  EXPECT_NEAR(images->turned_deg, 90.0, 1e-3);
  const FilmTrack* telemetry = info.first(FilmTrack::Kind::Telemetry);
  ASSERT_NE(telemetry, nullptr);
  EXPECT_EQ(telemetry->tag, "gpmd");
  EXPECT_EQ(telemetry->stated_count, 2);
}

TEST_F(FilmTest, ReadsTheBytesOfATelemetryTrack) {
  TestFilm film;
  film.telemetry = {{0.0, 0.4, {1, 2, 3}}, {0.4, 0.6, {4, 5}}};
  const std::filesystem::path file = write(film);
  FilmTrackReader reader(file, describeFilm(file).first(FilmTrack::Kind::Telemetry)->index);
  const std::optional<FilmPacket> first = reader.next(), second = reader.next();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->bytes, (std::vector<uint8_t>{1, 2, 3}));
  EXPECT_EQ(second->bytes, (std::vector<uint8_t>{4, 5}));
  EXPECT_NEAR(second->time.seconds(), 0.4, 1e-6);
  EXPECT_NEAR(first->length.seconds(), 0.4, 1e-6);
  EXPECT_FALSE(reader.next());
}

TEST_F(FilmTest, GivesTimesInOrderWithReorderedImages) {
  for (const char* name : {"film.mp4", "film.mkv", "film.mov"}) {
    TestFilm film;
    film.reordered = 2;
    const std::vector<double> times_s = timesOf(write(film, name));
    ASSERT_EQ(times_s.size(), 30U) << name;
    for (size_t i = 0; i < times_s.size(); ++i) {
      EXPECT_NEAR(times_s[i] - times_s[0], static_cast<double>(i) / 30.0, 1.1e-3) << name << " " << i;
    }
  }
}

TEST_F(FilmTest, DecodesTheImageOfEachTime) {
  for (const int reordered : {0, 2}) {
    TestFilm film;
    film.reordered = reordered;
    const std::filesystem::path file = write(film);
    FilmDecoder decoder(file, 0, {});
    FilmFrameTimes times(file, 0);
    int number = 0;
    while (const std::optional<Duration> time = times.next()) {
      const LoadedImage image = decoder.load(*time);
      EXPECT_EQ(image.problem, "");
      EXPECT_EQ(image.image.size(), cv::Size(64, 48));
      EXPECT_EQ(numberOf(image), number++);
    }
    EXPECT_EQ(number, 30);
  }
}

TEST_F(FilmTest, DecodesInAnyOrder) {
  TestFilm film;
  film.images = 40;
  const std::filesystem::path file = write(film);
  FilmDecoder decoder(file, 0, {});
  for (const int number : {5, 3, 31, 30, 0, 39, 12}) {
    EXPECT_EQ(numberOf(decoder.load(Duration::fromNanoseconds(number * 1'000'000'000LL / 30 + 2'000'000))),
              -1)
        << "a time that no image has";
  }
  std::vector<Duration> times;
  FilmFrameTimes reader(file, 0);
  while (const std::optional<Duration> time = reader.next()) times.push_back(*time);
  for (const int number : {5, 3, 31, 30, 0, 39, 12}) {
    EXPECT_EQ(numberOf(decoder.load(times[static_cast<size_t>(number)])), number);
  }
}

TEST_F(FilmTest, DecodesAnImageOnceThatIsLoadedTwice) {
  const std::filesystem::path file = write(TestFilm());
  FilmDecoder decoder(file, 0, {});
  FilmFrameTimes times(file, 0);
  int number = 0;
  while (const std::optional<Duration> time = times.next()) {
    for (int repeat = 0; repeat < 3; ++repeat) EXPECT_EQ(numberOf(decoder.load(*time)), number);
    ++number;
  }
  EXPECT_EQ(decoder.decoded(), 30);
}

TEST_F(FilmTest, DecodesTheLastImagesOnceWhereTheyAreReordered) {
  TestFilm film;
  film.reordered = 2;
  const std::filesystem::path file = write(film);
  FilmDecoder decoder(file, 0, {});
  FilmFrameTimes times(file, 0);
  int number = 0;
  while (const std::optional<Duration> time = times.next())
    EXPECT_EQ(numberOf(decoder.load(*time)), number++);
  EXPECT_EQ(decoder.decoded(), 30);
}

TEST_F(FilmTest, LeavesOutWhatIsBeforeAKeyImage) {
  for (const int reordered : {0, 2}) {
    TestFilm film;
    film.images = 200;
    film.reordered = reordered;
    const std::filesystem::path file = write(film);
    std::vector<Duration> times;
    FilmFrameTimes reader(file, 0);
    while (const std::optional<Duration> time = reader.next()) times.push_back(*time);
    FilmDecoder decoder(file, 0, {});
    for (const int number : {5, 60, 61, 63, 119, 120, 121, 193}) {
      EXPECT_EQ(numberOf(decoder.load(times[static_cast<size_t>(number)])), number % 40) << number;
    }
    // Of the longest group of images, at most, for each of the four jumps, and the images in between.
    EXPECT_LE(decoder.decoded(), 4 * 13 + 12);
  }
}

TEST_F(FilmTest, DecodesInAnyOrderWithoutAnIndex) {
  TestFilm film;
  film.images = 40;
  film.reordered = 2;
  const std::filesystem::path file = write(film, "film.ts");
  std::vector<Duration> times;
  FilmFrameTimes reader(file, 0);
  while (const std::optional<Duration> time = reader.next()) times.push_back(*time);
  ASSERT_EQ(times.size(), 40U);
  FilmDecoder decoder(file, 0, {});
  for (const int number : {0, 39, 38, 3, 37, 36, 14, 1, 35, 2}) {
    EXPECT_EQ(numberOf(decoder.load(times[static_cast<size_t>(number)])), number);
  }
}

TEST_F(FilmTest, DecodesForSeveralThreads) {
  TestFilm film;
  film.images = 40;
  const std::filesystem::path file = write(film);
  FilmDecoder decoder(file, 0, {});
  std::vector<Duration> times;
  FilmFrameTimes reader(file, 0);
  while (const std::optional<Duration> time = reader.next()) times.push_back(*time);
  for (const Duration time : times) decoder.announce(time);
  std::vector<int> numbers(times.size(), -1);
  std::vector<std::thread> threads;
  for (size_t first = 0; first < 4; ++first) {
    threads.emplace_back([&, first] {
      for (size_t i = first; i < times.size(); i += 4) numbers[i] = numberOf(decoder.load(times[i]));
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], static_cast<int>(i));
}

TEST_F(FilmTest, ScalesDown) {
  TestFilm film;
  film.images = 2;
  FilmDecoder decoder(write(film), 0, cv::Size(32, 24));
  const LoadedImage image = decoder.load(Duration());
  EXPECT_EQ(image.image.size(), cv::Size(32, 24));
  EXPECT_EQ(numberOf(image), 0);
}

TEST_F(FilmTest, FollowsAnEmptyEditAtTheStart) {
  TestFilm film;
  film.images_start_s = 0.5;
  film.telemetry = {{0.0, 1.5, {1}}};
  const std::filesystem::path file = write(film);
  const std::vector<double> times_s = timesOf(file);
  ASSERT_EQ(times_s.size(), 30U);
  EXPECT_NEAR(times_s.front(), 0.5, 1e-3);
  FilmTrackReader telemetry(file, 1);
  EXPECT_NEAR(telemetry.next()->time.seconds(), 0.0, 1e-3);
}

TEST_F(FilmTest, LeavesOutImagesThatAnEditCutsOff) {
  TestFilm film;
  film.images_start_s = -0.2;  // six images of 30
  const std::filesystem::path file = write(film);
  const std::vector<double> times_s = timesOf(file);
  ASSERT_EQ(times_s.size(), 24U);
  EXPECT_NEAR(times_s.front(), 0.0, 1e-3);
  FilmDecoder decoder(file, 0, {});
  EXPECT_EQ(numberOf(decoder.load(Duration::fromSeconds(times_s.front()))), 6);
}

TEST_F(FilmTest, ReadsACutOffFilmAsFarAsItGoes) {
  TestFilm film;
  film.images = 90;
  film.index_first = true;
  film.width_px = film.height_px = 256;
  film.codec = "mjpeg";
  const std::filesystem::path file = write(film, "film.mov");
  cutOff(file, 0.6);
  const size_t count = timesOf(file).size();
  EXPECT_GT(count, 30U);
  EXPECT_LT(count, 80U);
  EXPECT_EQ(describeFilm(file).first(FilmTrack::Kind::Images)->stated_count, 90);
}

TEST_F(FilmTest, NamesTheReasonWhereThereIsNoIndex) {
  const std::filesystem::path file = write(TestFilm());
  cutOff(file, 0.6);
  EXPECT_THAT(refusalOf(file), HasSubstr("its index is missing or damaged"));
  EXPECT_THAT(refusalOf(folder_.path("absent.mp4")), HasSubstr("no such file"));
  folder_.write("text.mp4", "no film");
  EXPECT_THAT(refusalOf(folder_.path("text.mp4")), HasSubstr("no film"));
}

TEST_F(FilmTest, ReadsManyPixelFormats) {
  for (const char* codec : {"mjpeg", "ffv1", "mpeg4"}) {  // full range, lossless, limited range
    TestFilm film;
    film.codec = codec;
    film.images = 3;
    const std::filesystem::path file = folder_.path(std::string(codec) + ".mov");
    test::writeFilm(file, film);
    std::vector<Duration> times;
    FilmFrameTimes reader(file, 0);
    while (const std::optional<Duration> time = reader.next()) times.push_back(*time);
    ASSERT_EQ(times.size(), 3U) << codec;
    FilmDecoder decoder(file, 0, {});
    EXPECT_EQ(numberOf(decoder.load(times[2])), 2) << codec;
  }
}

TEST(MessageDecoder, RefusesAnUnknownCodec) { EXPECT_THROW(MessageDecoder("no such codec"), InputError); }

TEST(MessageDecoder, TellsDamagedMessages) {
  if (!canReadFilms()) GTEST_SKIP() << "built without FFmpeg";
  MessageDecoder decoder("h264");
  EXPECT_NE(decoder.decode(std::vector<uint8_t>{1, 2, 3}).problem, "");
  EXPECT_NE(decoder.decode({}).problem, "");
}

}  // namespace
}  // namespace lodeline

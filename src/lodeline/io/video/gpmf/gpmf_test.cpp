#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/io/video/gpmf/gpmf_payload.h"
#include "lodeline/io/video/gpmf/klv_reader.h"
#include "lodeline/io/video/gpmf/test_gpmf.h"

namespace lodeline::gpmf {
namespace {

using test::Bytes;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::optional<std::vector<double>> numbers(char type, size_t size, size_t repeats, const Bytes& content,
                                           const std::string& types = {}) {
  const Bytes bytes = test::element("TEST", type, size, repeats, content);
  ElementReader reader(bytes);
  const std::optional<Element> element = reader.next();
  return element ? numbersOf(*element, types) : std::nullopt;
}

/// A payload with one stream of these elements.
Payload stream(const std::vector<Bytes>& elements) {
  return parsePayload(test::nested(
      "DEVC", {test::number32("DVID", 7), test::text("DVNM", "Camera"), test::nested("STRM", elements)}));
}

TEST(Gpmf, ReadsEveryTypeOfNumber) {
  EXPECT_THAT(*numbers('b', 1, 2, {0xff, 0x7f}), ElementsAre(-1.0, 127.0));
  EXPECT_THAT(*numbers('B', 1, 1, {0xff}), ElementsAre(255.0));
  EXPECT_THAT(*numbers('s', 4, 1, {0xff, 0xfe, 0x01, 0x00}), ElementsAre(-2.0, 256.0));
  EXPECT_THAT(*numbers('S', 2, 1, {0xff, 0xfe}), ElementsAre(65534.0));
  EXPECT_THAT(*numbers('l', 4, 1, {0xff, 0xff, 0xff, 0xfd}), ElementsAre(-3.0));
  EXPECT_THAT(*numbers('L', 4, 1, {0xff, 0xff, 0xff, 0xfd}), ElementsAre(4294967293.0));
  EXPECT_THAT(*numbers('f', 4, 1, {0x3f, 0xc0, 0, 0}), ElementsAre(1.5));
  EXPECT_THAT(*numbers('d', 8, 1, {0x3f, 0xf8, 0, 0, 0, 0, 0, 0}), ElementsAre(1.5));
  EXPECT_THAT(*numbers('j', 8, 1, {0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe}), ElementsAre(-2.0));
  EXPECT_THAT(*numbers('J', 8, 1, {0, 0, 0, 1, 0, 0, 0, 0}), ElementsAre(4294967296.0));
  EXPECT_THAT(*numbers('q', 4, 1, {0xff, 0xff, 0x80, 0x00}), ElementsAre(-0.5));
  EXPECT_THAT(*numbers('Q', 8, 1, {0, 0, 0, 2, 0x40, 0, 0, 0}), ElementsAre(2.25));
  EXPECT_TRUE(std::isnan(numbers('F', 4, 1, {'T', 'e', 's', 't'})->front()));
  EXPECT_TRUE(std::isnan(numbers('U', 16, 1, Bytes(16, '0'))->front()));
  EXPECT_TRUE(std::isnan(numbers('G', 16, 1, Bytes(16, 1))->front()));
  EXPECT_TRUE(std::isnan(numbers('c', 1, 1, {'1'})->front()));
}

TEST(Gpmf, RefusesSizesThatDoNotFitTheType) {
  EXPECT_FALSE(numbers('s', 3, 1, {1, 2, 3}));
  EXPECT_FALSE(numbers('f', 0, 1, {}));
  EXPECT_FALSE(numbers('z', 4, 1, {1, 2, 3, 4}));
  EXPECT_FALSE(numbers('?', 4, 1, {1, 2, 3, 4}));
  EXPECT_FALSE(numbers('?', 4, 1, {1, 2, 3, 4}, "ff"));
}

TEST(Gpmf, ReadsComplexSamples) {
  EXPECT_THAT(*numbers('?', 4, 2, {0, 1, 2, 3, 0xff, 0xff, 4, 5}, "sBB"), ElementsAre(1, 2, 3, -1, 4, 5));
  EXPECT_EQ(expandedTypes("f[3]L"), "fffL");
  EXPECT_EQ(expandedTypes(std::string("Ls\0", 3)), "Ls");
  for (const char* wrong : {"[3]f", "f[", "f[]", "f[a]", "f[0]", "f[999]", "f[255]f[255]", "x", "f[3"}) {
    EXPECT_EQ(expandedTypes(wrong), "") << wrong;
  }
}

TEST(Gpmf, ReadsAStreamWithItsDescription) {
  const Payload payload =
      stream({test::number32("TSMP", 196), test::number64("STMP", 10050065), test::number32("TICK", 151759),
              test::text("STNM", "Gyroscope (z,x,y)"), test::text("SIUN", "rad/s"),
              test::shorts("SCAL", 1, {4}), test::text("ORIN", "zxY"), test::text("ORIO", "ZXY"),
              test::floats("MTRX", 9, {-1, 0, 0, 0, -1, 0, 0, 0, 1}),
              test::shorts("GYRO", 3, {4, 8, -12, 1, 2, 3})});
  EXPECT_THAT(payload.problems, IsEmpty());
  ASSERT_THAT(payload.streams, SizeIs(1));
  const Stream& gyro = payload.streams.front();
  EXPECT_EQ(gyro.key, "GYRO");
  EXPECT_EQ(gyro.device, 7.0);
  EXPECT_EQ(gyro.device_name, "Camera");
  EXPECT_EQ(gyro.samples, 2U);
  EXPECT_THAT(gyro.values, ElementsAre(1.0, 2.0, -3.0, 0.25, 0.5, 0.75));
  EXPECT_EQ(gyro.unit, "rad/s");
  EXPECT_EQ(gyro.total_samples, 196U);
  EXPECT_EQ(gyro.stamp_us, 10050065);
  EXPECT_EQ(gyro.tick_ms, 151759);
  EXPECT_EQ(gyro.stored_axes, "zxY");
  ASSERT_TRUE(gyro.matrix);
  EXPECT_EQ((*gyro.matrix)(1, 1), -1.0);
}

TEST(Gpmf, ScalesEachNumberAndTakesTheFirstUnit) {
  const Payload payload =
      stream({test::element("UNIT", 'c', 3, 3, {'d', 'e', 'g', 'd', 'e', 'g', 'm', 0, 0}),
              test::shorts("SCAL", 1, {10, 100, 1}), test::shorts("GPS5", 3, {10, 100, 7})});
  ASSERT_THAT(payload.streams, SizeIs(1));
  EXPECT_THAT(payload.streams[0].values, ElementsAre(1.0, 1.0, 7.0));
  EXPECT_EQ(payload.streams[0].unit, "deg");
  const Payload letters = stream({test::text("UNIT", "mmm"), test::shorts("GRAV", 3, {1, 2, 3})});
  ASSERT_THAT(letters.streams, SizeIs(1));
  EXPECT_EQ(letters.streams[0].unit, "m");
}

TEST(Gpmf, JoinsRepeatedElementsOfOneStream) {
  const Payload payload = stream(
      {test::shorts("FACE", 2, {1, 2}), test::shorts("FACE", 2, {}), test::shorts("FACE", 2, {3, 4, 5, 6})});
  ASSERT_THAT(payload.streams, SizeIs(1));
  EXPECT_THAT(payload.streams[0].values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Gpmf, PassesOverStreamsWithoutData) {
  EXPECT_THAT(
      stream({test::number32("EMPT", 3), test::number32("TSMP", 8), test::text("FWVS", "1.1")}).streams,
      IsEmpty());
  EXPECT_THAT(stream({test::number32("TSMP", 0), test::text("STNM", "3A STATS")}).streams, IsEmpty());
  EXPECT_THAT(stream({test::shorts("GYRO", 3, {})}).streams, IsEmpty());
  EXPECT_THAT(stream({}).streams, IsEmpty());
}

TEST(Gpmf, ToldProblemsLeaveTheOtherStreams) {
  const Bytes good = test::nested("STRM", {test::shorts("ACCL", 3, {1, 2, 3})});
  const auto with = [&](const Bytes& bad) { return parsePayload(test::nested("DEVC", {bad, good})); };
  const Payload zero =
      with(test::nested("STRM", {test::shorts("SCAL", 1, {0}), test::shorts("GYRO", 3, {1, 2, 3})}));
  ASSERT_THAT(zero.streams, SizeIs(1));
  EXPECT_EQ(zero.streams[0].key, "ACCL");
  EXPECT_THAT(zero.problems, ElementsAre(HasSubstr("GYRO: its scale")));
  const Payload type = with(test::nested("STRM", {test::element("GYRO", 's', 5, 1, {1, 2, 3, 4, 5})}));
  EXPECT_THAT(type.problems, ElementsAre(HasSubstr("GYRO: type 's' does not fit samples of 5 bytes")));
  EXPECT_THAT(type.streams, SizeIs(1));
  const Payload scales =
      with(test::nested("STRM", {test::shorts("SCAL", 1, {1, 2}), test::shorts("GYRO", 3, {1, 2, 3})}));
  EXPECT_THAT(scales.problems, SizeIs(1));
}

TEST(Gpmf, EndsAtElementsThatAreTooLong) {
  Bytes inner = test::shorts("GYRO", 3, {1, 2, 3});
  inner[7] = 200;  // repeats
  Bytes payload = test::nested("DEVC", {test::nested("STRM", {inner})});
  const Payload parsed = parsePayload(payload);
  EXPECT_THAT(parsed.streams, IsEmpty());
  EXPECT_THAT(parsed.problems, ElementsAre(HasSubstr("element GYRO of 1200 bytes in the last")));
}

TEST(Gpmf, ReadsAnyCutOffPayloadWithoutCrash) {
  const Bytes whole = test::payloadsOf({test::TestSensor(), test::TestSensor{"ACCL", "m/s2"}}, 1).front();
  size_t told = 0;
  for (size_t length = 0; length < whole.size(); ++length) {
    const Payload payload = parsePayload({whole.data(), length});
    told += payload.problems.empty() ? 0U : 1U;
  }
  EXPECT_EQ(told, whole.size() - 1);  // all but the empty one
}

TEST(Gpmf, EndsAtFilling) {
  Bytes payload = test::nested("DEVC", {test::nested("STRM", {test::shorts("GYRO", 3, {1, 2, 3})})});
  payload.resize(payload.size() + 100, 0);
  const Payload parsed = parsePayload(payload);
  EXPECT_THAT(parsed.streams, SizeIs(1));
  EXPECT_THAT(parsed.problems, IsEmpty());
}

}  // namespace
}  // namespace lodeline::gpmf

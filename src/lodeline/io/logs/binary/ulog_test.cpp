#include "lodeline/io/logs/binary/ulog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/test_logs.h"

namespace lodeline {
namespace {

using test::raws;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

ULog open(const std::string& bytes) { return ULog(bytesInMemory(bytes), "a.ulg"); }

/// The values of one field in all messages of a topic.
std::vector<double> valuesOf(ULog* log, const std::string& topic, const std::string& field,
                             int instance = 0) {
  std::vector<double> values;
  for (LogMessage message; log->next(&message);) {
    if (message.format->topic != topic || message.instance != instance) continue;
    const LogField* found = message.format->field(field);
    values.push_back(found == nullptr ? -1.0 : message.value(*found).value_or(-2.0));
  }
  return values;
}

/// A log with a topic whose messages hold a number each.
test::ULogBytes begun() {
  test::ULogBytes log;
  log.flags(0).format("number:uint64_t timestamp;float value;").subscribe(3, "number");
  return log;
}
std::string numbered(float value) { return raws<uint64_t, float>(1000, value); }

TEST(ULog, ReadsNumbersOfEveryType) {
  test::ULogBytes log;
  log.flags(0)
      .format(
          "all:uint64_t timestamp;int8_t a;uint8_t b;int16_t c;uint16_t "
          "d;int32_t e;uint32_t f;"
          "int64_t g;float h;double i;bool j;char[5] text;float[2] "
          "k;uint8_t[3] _padding0;")
      .subscribe(7, "all");
  log.data(7, raws<uint64_t, int8_t, uint8_t, int16_t, uint16_t>(1, -2, 250, -300, 60000) +
                  raws<int32_t, uint32_t, int64_t, float, double>(-70000, 4000000000U, -5, 0.5F, 0.25) +
                  raws<uint8_t>(1) + "hello" + raws<float, float>(1.5F, 2.5F));
  const std::pair<const char*, double> expected[] = {
      {"timestamp", 1}, {"a", -2},  {"b", 250},  {"c", -300}, {"d", 60000},  {"e", -70000}, {"f", 4e9},
      {"g", -5},        {"h", 0.5}, {"i", 0.25}, {"j", 1},    {"k[0]", 1.5}, {"k[1]", 2.5}};
  for (const auto& [name, value] : expected) {
    ULog ulog = open(log.bytes());
    EXPECT_THAT(valuesOf(&ulog, "all", name), ElementsAre(value)) << name;
  }
}

TEST(ULog, ReadsNestedDefinitionsInAnyOrder) {
  test::ULogBytes log;
  log.flags(0)
      .format("outer:uint64_t timestamp;inner[2] part;uint8_t last;")
      .format("inner:float x;uint16_t[2] y;")
      .subscribe(1, "outer");
  log.data(1, raws<uint64_t, float, uint16_t, uint16_t, float, uint16_t, uint16_t, uint8_t>(1, 1.0F, 2, 3,
                                                                                            4.0F, 5, 6, 7));
  for (const auto& [name, value] : {std::pair("part[0].x", 1.0), {"part[1].y[1]", 6.0}, {"last", 7.0}}) {
    ULog ulog = open(log.bytes());
    EXPECT_THAT(valuesOf(&ulog, "outer", name), ElementsAre(value)) << name;
  }
}

TEST(ULog, KeepsInstancesApartAndEndsSubscriptions) {
  test::ULogBytes log = begun();
  log.subscribe(4, "number", 2).data(3, numbered(1)).data(4, numbered(2));
  log.message('R', raws<uint16_t>(3)).data(3, numbered(9)).data(4, numbered(3));
  ULog first = open(log.bytes()), third = open(log.bytes());
  EXPECT_THAT(valuesOf(&first, "number", "value"), ElementsAre(1));
  EXPECT_THAT(valuesOf(&third, "number", "value", 2), ElementsAre(2, 3));
}

TEST(ULog, ContinuesAfterDamageAtASynchronization) {
  test::ULogBytes log = begun();
  log.data(3, numbered(1)).junk("\xFF\xFF\xFF\xFFnothing of use").sync().data(3, numbered(2));
  ULog ulog = open(log.bytes());
  EXPECT_THAT(valuesOf(&ulog, "number", "value"), ElementsAre(1, 2));
  EXPECT_EQ(ulog.damage().places, 1);
  EXPECT_EQ(ulog.damage().bytes, 18U);
  EXPECT_FALSE(ulog.damage().is_cut_off);
}

TEST(ULog, SkipsMessagesOfLaterVersions) {
  test::ULogBytes log = begun();
  log.message('Z', "unknown").data(3, numbered(2));
  ULog ulog = open(log.bytes());
  EXPECT_THAT(valuesOf(&ulog, "number", "value"), ElementsAre(2));
  EXPECT_EQ(ulog.damage().places, 0);
}

TEST(ULog, ReadsAppendedDataBehindACutMessage) {
  // The logger stopped within a message; what follows was appended later.
  test::ULogBytes measure = begun();
  measure.data(3, numbered(1));
  const uint64_t end = measure.bytes().size() + 5;
  test::ULogBytes log;
  log.flags(1, end).format("number:uint64_t timestamp;float value;").subscribe(3, "number");
  log.data(3, numbered(1)).junk(std::string("\x40\0D\3\0", 5));
  ASSERT_EQ(log.bytes().size(), end);
  log.data(3, numbered(5));
  ULog ulog = open(log.bytes());
  EXPECT_THAT(valuesOf(&ulog, "number", "value"), ElementsAre(1, 5));
  EXPECT_EQ(ulog.damage().places, 0);
}

TEST(ULog, TellsWhereItIsCutOff) {
  test::ULogBytes log = begun();
  log.data(3, numbered(1)).data(3, numbered(2));
  for (size_t cut = 1; cut < 17; ++cut) {
    ULog ulog = open(log.bytes().substr(0, log.bytes().size() - cut));
    EXPECT_THAT(valuesOf(&ulog, "number", "value"), ElementsAre(1)) << cut;
    EXPECT_TRUE(ulog.damage().is_cut_off) << cut;
  }
}

TEST(ULog, RefusesWhatItCannotRead) {
  EXPECT_THAT([] { open("ULog\x01\x12"); }, ThrowsMessage<InputError>(HasSubstr("no complete header")));
  test::ULogBytes later;
  later.flags(2);
  ULog ulog = open(later.bytes());
  LogMessage message;
  EXPECT_THAT([&] { ulog.next(&message); }, ThrowsMessage<InputError>(HasSubstr("features")));
}

TEST(ULog, LeavesOutTopicsWithImpossibleDefinitions) {
  test::ULogBytes log;
  log.flags(0).format("loop:loop again;").format("huge:uint8_t[99999999] x;").format("wide:deep[60000] x;");
  log.format("deep:double[60000] x;").subscribe(1, "loop").subscribe(2, "huge").subscribe(3, "wide");
  log.subscribe(4, "absent");
  for (uint16_t id = 1; id <= 4; ++id) log.data(id, "12345678");
  ULog ulog = open(log.bytes());
  LogMessage message;
  EXPECT_FALSE(ulog.next(&message));
}

}  // namespace
}  // namespace lodeline

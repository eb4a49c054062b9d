#include "lodeline/io/rosbag/definitions/message_conversion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/io/rosbag/definitions/definition_parser.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"
#include "lodeline/io/rosbag/definitions/message_text.h"

namespace lodeline::definitions {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMixed =
    "uint8 LIMIT=7\n"
    "string<=5 NAME = 'a # b'\n"
    "uint8 a   # a comment\n"
    "float64 b 1.5\n"
    "string<=10 s \"x\"\n"
    "uint16[<=4] c\n"
    "Inner[2] inner\n"
    "builtin_interfaces/Time stamp\n"
    "================================================================================\n"
    "MSG: test/msg/Inner\n"
    "int8 i\n"
    "bool[] flags\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\n"
    "int32 sec\n"
    "uint32 nanosec\n";

constexpr const char* kMixedText =
    "{a: 9, b: -2.5, s: \"h\\\"i\", c: [1, 515], inner: [{i: -1, flags: [true, false]}, {i: 5, flags: []}], "
    "stamp: {sec: -2, nanosec: 3}}";

// Written out by hand from the rules of XCDR1: alignment counts from the byte after the header.
const wire::Bytes kLittle = {
    0,    1,    0,    0,                                 // little-endian CDR
    9,    0,    0,    0,    0,   0,   0,    0,           // a, padding to 8
    0,    0,    0,    0,    0,   0,   0x04, 0xC0,        // b
    4,    0,    0,    0,    'h', '"', 'i',  0,           // s with its zero
    2,    0,    0,    0,    1,   0,   3,    2,           // c
    0xFF, 0,    0,    0,    2,   0,   0,    0,    1, 0,  // the first inner message
    5,    0,    0,    0,    0,   0,                      // the second one: padding to 4 after one byte
    0xFE, 0xFF, 0xFF, 0xFF, 3,   0,   0,    0,           // stamp
};
const wire::Bytes kBig = {
    0, 0, 0, 0, 9,   0,   0,   0, 0, 0, 0, 0, 0xC0, 0x04, 0,    0,    0,    0, 0, 0,
    0, 0, 0, 4, 'h', '"', 'i', 0, 0, 0, 0, 2, 0,    1,    2,    3,    0xFF, 0, 0, 0,
    0, 0, 0, 2, 1,   0,   5,   0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFE, 0,    0, 0, 3,
};

TEST(MessageTextTest, ReadsBothByteOrdersWithTheAlignmentOfCdr) {
  const TypeDescription type = parseDefinition("test/Mixed", kMixed, Serialization::Cdr);
  EXPECT_EQ(messageText(kLittle, type, Serialization::Cdr, 100), kMixedText);
  EXPECT_EQ(messageText(kBig, type, Serialization::Cdr, 100), kMixedText);
}

TEST(MessageTextTest, EveryShorterMessageIsCutOff) {
  const TypeDescription type = parseDefinition("test/Mixed", kMixed, Serialization::Cdr);
  for (size_t size = 0; size < kLittle.size(); ++size) {
    EXPECT_THROW(messageText(std::span(kLittle).first(size), type, Serialization::Cdr, 100),
                 wire::Reader::CutOff)
        << size;
  }
}

TEST(MessageTextTest, CutsLongArraysAndTellsOfBytesWithoutDescription) {
  const TypeDescription type = parseDefinition("a/B", "uint8[] d\n", Serialization::Cdr);
  EXPECT_EQ(messageText(wire::Bytes{0, 1, 0, 0, 3, 0, 0, 0, 7, 8, 9}, type, Serialization::Cdr, 2),
            "{d: [7, 8, … (3 elements)]}");
  EXPECT_EQ(messageText(wire::Bytes{0, 1, 0, 0, 0, 0, 0, 0, 7, 8, 9, 10}, type, Serialization::Cdr, 2),
            "{d: []} + 4 bytes that the definition does not describe");
}

TEST(MessageTextTest, SecondVersionOfCdrAlignsToFourBytes) {
  const TypeDescription type = parseDefinition("a/B", "uint8 a\nfloat64 b\n", Serialization::Cdr);
  const wire::Bytes message = {0, 7, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F};
  EXPECT_EQ(messageText(message, type, Serialization::Cdr, 9), "{a: 1, b: 1}");
  wire::Bytes parameter_list = message;
  parameter_list[1] = 3;
  EXPECT_THROW(messageText(parameter_list, type, Serialization::Cdr, 9), DefinitionError);
}

TEST(DefinitionParserTest, AServiceDescribesItsEvents) {
  const TypeDescription type = parseDefinition("example_interfaces/srv/AddTwoInts_Event",
                                               "int64 a\nint64 b\n---\nint64 sum\n", Serialization::Cdr);
  ASSERT_EQ(type.root().fields.size(), 3u);
  EXPECT_EQ(type.root().fields[1].name, "request");
  EXPECT_EQ(type.messages[type.root().fields[2].message].fields[0].name, "sum");
}

TEST(DefinitionParserTest, RefusesWhatCannotBeDecoded) {
  const auto refusal = [](const char* text) -> std::string {
    try {
      parseDefinition("a/B", text, Serialization::Cdr);
    } catch (const DefinitionError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal("Missing m\n"), HasSubstr("does not describe a/Missing"));
  EXPECT_THAT(refusal("B[] b\n"), HasSubstr("a/B contains itself"));
  EXPECT_THAT(refusal("uint8[x] b\n"), HasSubstr("'x' is no number"));
  EXPECT_THAT(refusal("uint8\n"), HasSubstr("has no name"));
  EXPECT_THAT(refusal("uint8 a\n==========\nIDL: a/C\n"), HasSubstr("IDL"));
}

TEST(MessageConversionTest, ReturnsToTheSameBytes) {
  const std::string type = "sensor_msgs/LaserScan";
  const MessageConversion there(knownForm(type, Serialization::Ros1), knownForm(type, Serialization::Cdr));
  const MessageConversion back(knownForm(type, Serialization::Cdr), knownForm(type, Serialization::Ros1));
  wire::Writer writer;
  writer.put(uint32_t{0});
  writer.putTime(Time::fromNanoseconds(12'000'000'345));
  writer.putText("head");
  for (int i = 0; i < 7; ++i) writer.put(0.5F * static_cast<float>(i));
  writer.put(uint32_t{3});
  for (int i = 0; i < 3; ++i) writer.put(1.5F);
  writer.put(uint32_t{0});
  const wire::Bytes message = writer.take();
  const wire::Bytes cdr = there.convert(message);
  EXPECT_EQ(cdr.size(), 4 + 8 + 4 + 5 + 3 + 28 + 4 + 12 + 4) << "padding of 3 bytes after the name";
  EXPECT_EQ(back.convert(cdr), message);
}

TEST(MessageConversionTest, TakesFieldsByNameInAnyOrder) {
  const MessageForm from{parseDefinition("a/B", "string s\nuint8 extra\nfloat64 x\n", Serialization::Cdr),
                         Serialization::Cdr};
  const MessageForm to{parseDefinition("a/B", "float64 X\nstring s\n", Serialization::Ros1),
                       Serialization::Ros1};
  const wire::Bytes message = {0, 1, 0, 0, 4, 0, 0, 0, 'h', 'e', 'y', 0, 5,    0,
                               0, 0, 0, 0, 0, 0, 0, 0, 0,   0,   0,   0, 0xF0, 0x3F};
  EXPECT_EQ(MessageConversion(from, to).convert(message),
            (wire::Bytes{0, 0, 0, 0, 0, 0, 0xF0, 0x3F, 3, 0, 0, 0, 'h', 'e', 'y'}));
}

TEST(MessageConversionTest, RefusesFieldsOfAnotherKind) {
  const MessageForm from{parseDefinition("a/B", "float32 x\n", Serialization::Cdr), Serialization::Cdr};
  for (const char* other : {"float64 x\n", "float32[] x\n", "float32 y\n"}) {
    const MessageForm to{parseDefinition("a/B", other, Serialization::Ros1), Serialization::Ros1};
    EXPECT_THROW(MessageConversion(from, to), DefinitionError) << other;
  }
}

TEST(KnownDefinitionsTest, EveryDefinitionDescribesItself) {
  for (const char* type :
       {"sensor_msgs/Imu", "sensor_msgs/CameraInfo", "sensor_msgs/BatteryState", "nav_msgs/Odometry",
        "geometry_msgs/TwistWithCovarianceStamped", "tf2_msgs/TFMessage", "rcl_interfaces/ParameterEvent"}) {
    for (const Serialization serialization : {Serialization::Ros1, Serialization::Cdr}) {
      const TypeDescription embedded =
          parseDefinition(type, fullDefinition(type, serialization), serialization);
      const TypeDescription known = parseDefinition(type, "", serialization);
      EXPECT_EQ(embedded.messages.size(), known.messages.size()) << type;
    }
  }
}

}  // namespace
}  // namespace lodeline::definitions

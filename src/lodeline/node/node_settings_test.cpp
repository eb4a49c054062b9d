#include "lodeline/node/node_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Texts = std::vector<std::string>;

OptionValues with(const std::string& name, const OptionValue& value) {
  return {{"rig", "rig.yaml"}, {name, value}};
}

TEST(NodeSettings, TakeTheirValuesByName) {
  const NodeSettings settings = readNodeSettings({{"rig", Texts{"a.yaml", "b.yaml"}},
                                                  {"topics", Texts{"cam0=/left", "imu0=/gyro,/accel"}},
                                                  {"output", "result"},
                                                  {"max_images", int64_t{99}},
                                                  {"patience_s", int64_t{2}},
                                                  {"publish_tf", false},
                                                  {"body_frame", "imu"}});
  EXPECT_EQ(settings.rig_files, (Texts{"a.yaml", "b.yaml"}));
  EXPECT_EQ(settings.topicsBySensor().at("imu0"), "/gyro,/accel");
  EXPECT_EQ(settings.run.output, "result");
  EXPECT_EQ(settings.source.max_images, 99U);
  EXPECT_EQ(settings.source.patience_s, 2.0);
  EXPECT_FALSE(settings.publish_tf);
  EXPECT_TRUE(settings.report);
  EXPECT_EQ(settings.frames.body, "imu");
}

TEST(NodeSettings, EveryOptionCanBeGivenItsInitialValue) {
  OptionValues values;
  for (const NodeOption& option : nodeOptions()) {
    EXPECT_FALSE(option.meaning.empty()) << option.name;
    values[option.name] = option.initial;
  }
  values["rig"] = "rig.yaml";
  EXPECT_EQ(readNodeSettings(values).source.max_images, LiveSourceOptions().max_images);
}

TEST(NodeSettings, QualityOfServiceIsThatOfTheLastEntry) {
  const NodeSettings settings =
      readNodeSettings(with("qos", Texts{"all=reliable:7", "imu0=best_effort", "cam1=reliable"}));
  EXPECT_TRUE(settings.qosOf("cam0").is_reliable);
  EXPECT_EQ(settings.qosOf("cam0").depth, 7);
  EXPECT_FALSE(settings.qosOf("imu0").is_reliable);
  EXPECT_EQ(settings.qosOf("cam1").depth, 0);
  EXPECT_FALSE(readNodeSettings({{"rig", "a"}}).qosOf("cam0").is_reliable);
}

TEST(NodeSettings, SayWhatIsWrong) {
  const auto says = [](const OptionValues& values, const char* text) {
    EXPECT_THAT([&] { readNodeSettings(values); }, ThrowsMessage<UsageError>(HasSubstr(text)));
  };
  says({}, "rig: missing");
  says(with("outptu", "x"), "did you mean output?");
  says(with("max_images", "many"), "max_images: has a value of the wrong type");
  says(with("max_images", int64_t{0}), "not positive");
  says(with("patience_s", 0.0), "not positive");
  says(with("topics", Texts{"/left"}), "SENSOR=VALUE");
  for (const char* bad : {"all=perfect", "all=reliable:", "all=reliable:0", "all=reliable:5x", "reliable"}) {
    says(with("qos", Texts{bad}), "qos: ");
  }
}

}  // namespace
}  // namespace lodeline

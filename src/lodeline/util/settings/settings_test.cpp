#include "lodeline/util/settings/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

enum class Model { Paper, Absolute, Off };

class SettingsTest : public testing::Test {
 protected:
  SettingsTest() {
    settings_.bind("front_end.max_features", &max_features_, "features kept per image");
    settings_.bind("front_end.equalize", &equalize_, "local contrast");
    settings_.bind("magnetometer.model", &model_,
                   {{"paper", Model::Paper}, {"absolute", Model::Absolute}, {"off", Model::Off}}, "residual");
    settings_.bind("magnetometer.prior.sigma_T", &sigma_T_, "offset\nprior");
    settings_.bind("front_end.scales", &scales_, "pyramid");
    settings_.bind("name", &name_, "of the dive");
  }

  std::filesystem::path file(const std::string& text) {
    const std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) /
        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + ".yaml");
    std::ofstream(path) << text;
    return path;
  }

  auto loading(const std::string& text) {
    return [this, path = file(text)] { settings_.load(path); };
  }

  int max_features_ = 300;
  bool equalize_ = true;
  Model model_ = Model::Absolute;
  double sigma_T_ = 3e-7;
  std::vector<double> scales_ = {1.0, 0.1};
  std::string name_ = "a \"deep\" one";
  Settings settings_;
};

TEST_F(SettingsTest, LoadsEveryKind) {
  settings_.load(
      file("front_end:\n  max_features: 12\n  equalize: off\n  scales: [1, 2.5e-3]\n"
           "magnetometer:\n  model: paper\n  prior: {sigma_T: 1e-6}\nname: Devil's Eye\r\n"));
  EXPECT_EQ(max_features_, 12);
  EXPECT_FALSE(equalize_);
  EXPECT_THAT(scales_, ElementsAre(1.0, 2.5e-3));
  EXPECT_EQ(model_, Model::Paper);
  EXPECT_EQ(sigma_T_, 1e-6);
  EXPECT_EQ(name_, "Devil's Eye");
}

TEST_F(SettingsTest, EmptyFileAndEmptySectionChangeNothing) {
  settings_.load(file("# nothing\n"));
  settings_.load(file("front_end:\n"));
  EXPECT_EQ(max_features_, 300);
}

TEST_F(SettingsTest, UnknownKeyNamesFileLineAndNearestKey) {
  EXPECT_THAT(loading("name: x\nfront_end:\n  max_featurs: 3\n"),
              ThrowsMessage<UsageError>(AllOf(HasSubstr("UnknownKeyNamesFileLineAndNearestKey.yaml:3"),
                                              HasSubstr("'front_end.max_featurs'"),
                                              HasSubstr("'front_end.max_features'"))));
  EXPECT_THAT([&] { settings_.set("magnetometer.modell", "off"); },
              ThrowsMessage<UsageError>(AllOf(HasSubstr("command line"), HasSubstr("'magnetometer.model'"))));
}

TEST_F(SettingsTest, WrongKindSaysWhatIsExpected) {
  EXPECT_THAT(
      loading("front_end: {max_features: 3.5}"),
      ThrowsMessage<UsageError>(AllOf(HasSubstr(":1"), HasSubstr("a whole number, 0 or more, not '3.5'"))));
  EXPECT_THAT(loading("front_end: {max_features: }"), testing::Throws<UsageError>());
  EXPECT_THAT(loading("front_end: 3"), ThrowsMessage<UsageError>(HasSubstr("is a section")));
  EXPECT_THAT(loading("front_end: {equalize: 1}"), ThrowsMessage<UsageError>(HasSubstr("true or false")));
  EXPECT_THAT(loading("front_end: {scales: 1}"), ThrowsMessage<UsageError>(HasSubstr("a list of numbers")));
  EXPECT_THAT(loading("front_end: {scales: [1, x]}"), ThrowsMessage<UsageError>(HasSubstr("not '[1, x]'")));
  EXPECT_THAT(loading("name: {a: b}"), ThrowsMessage<UsageError>(HasSubstr("must be a text")));
  EXPECT_THAT(loading("magnetometer: {model: none}"),
              ThrowsMessage<UsageError>(HasSubstr("one of paper, absolute, off, not 'none'")));
  EXPECT_THAT(loading("magnetometer: {prior: {sigma_T: .nan}}"), testing::Throws<UsageError>());
  EXPECT_THAT([&] { settings_.set("front_end.max_features", "99999999999"); }, testing::Throws<UsageError>());
}

TEST_F(SettingsTest, RefusesWhatIsNoConfiguration) {
  EXPECT_THAT(loading("a: [1"), ThrowsMessage<UsageError>(HasSubstr("not valid YAML")));
  EXPECT_THAT(loading("- 1\n- 2\n"), ThrowsMessage<UsageError>(HasSubstr("key: value")));
  EXPECT_THAT(loading("name: a\nname: b\n"), ThrowsMessage<UsageError>(HasSubstr("more than once")));
  EXPECT_THAT([&] { settings_.load("/no/such/file.yaml"); },
              ThrowsMessage<UsageError>(HasSubstr("/no/such/file.yaml")));
}

TEST_F(SettingsTest, WritesSectionsTogetherWithDocumentation) {
  std::ostringstream written;
  settings_.write(written);
  EXPECT_EQ(written.str(),
            "front_end:\n"
            "  # features kept per image\n  max_features: 300\n"
            "  # local contrast\n  equalize: true\n"
            "  # pyramid\n  scales: [1, 0.1]\n"
            "magnetometer:\n"
            "  # residual One of paper, absolute, off.\n  model: absolute\n"
            "  prior:\n    # offset\n    # prior\n    sigma_T: 3e-07\n"
            "# of the dive\nname: \"a \\\"deep\\\" one\"\n");
}

TEST_F(SettingsTest, ReadsBackWhatItWroteToTheLastBit) {
  sigma_T_ = 0.1 + 0.2;
  scales_ = {1.0 / 3.0, -5e-324, 1.7976931348623157e308};
  name_ = "line\nbreak \\ # : ~";
  model_ = Model::Off;
  std::ostringstream written;
  settings_.write(written);
  const double sigma_T = std::exchange(sigma_T_, 0.0);
  const std::vector<double> scales = std::exchange(scales_, {});
  const std::string name = std::exchange(name_, "");
  model_ = Model::Paper;
  settings_.load(file(written.str()));
  EXPECT_EQ(sigma_T_, sigma_T);
  EXPECT_EQ(scales_, scales);
  EXPECT_EQ(name_, name);
  EXPECT_EQ(model_, Model::Off);
}

TEST_F(SettingsTest, CommandLineTakesYamlSpelling) {
  settings_.set("front_end.scales", "[3, 4]");
  settings_.set("name", "C: [x");
  settings_.set("front_end.equalize", "false");
  EXPECT_THAT(scales_, ElementsAre(3.0, 4.0));
  EXPECT_EQ(name_, "C: [x");
  EXPECT_FALSE(equalize_);
}

TEST_F(SettingsTest, ListsOfWholeNumbersTakeNoFractions) {
  std::vector<int> cameras;
  settings_.bind("cameras", &cameras, "by number");
  settings_.set("cameras", "[1, 0]");
  EXPECT_THAT(cameras, ElementsAre(1, 0));
  EXPECT_THAT([&] { settings_.set("cameras", "[0.5]"); }, testing::Throws<UsageError>());
  EXPECT_THAT([&] { settings_.set("cameras", "1"); }, testing::Throws<UsageError>());
  EXPECT_THAT(cameras, ElementsAre(1, 0));
}

TEST_F(SettingsTest, RefusesNumbersThatMakeNoSense) {
  int levels = 3;
  double density = 1.0;
  settings_.bind("levels", &levels, "of the pyramid", 1);
  settings_.bind("density", &density, "of the noise", Settings::Sign::Positive);
  EXPECT_THAT([&] { settings_.set("levels", "0"); },
              ThrowsMessage<UsageError>(HasSubstr("must be a whole number, 1 or more, not '0'")));
  EXPECT_THAT([&] { settings_.set("density", "0"); },
              ThrowsMessage<UsageError>(HasSubstr("must be a number above 0, not '0'")));
  EXPECT_THAT([&] { settings_.set("magnetometer.prior.sigma_T", "-1e-9"); },
              ThrowsMessage<UsageError>(HasSubstr("must be a number, 0 or more, not '-1e-9'")));
  EXPECT_THAT([&] { settings_.set("front_end.max_features", "-1"); }, testing::Throws<UsageError>());
  settings_.set("levels", "1");
  settings_.set("magnetometer.prior.sigma_T", "0");
  EXPECT_EQ(levels, 1);
  EXPECT_EQ(density, 1.0);
  EXPECT_EQ(sigma_T_, 0.0);
}

TEST_F(SettingsTest, RefusesToBindAKeyTwice) {
  int other = 0;
  EXPECT_THROW(settings_.bind("name", &other, ""), std::logic_error);
  EXPECT_THROW(settings_.bind("front_end", &other, ""), std::logic_error);
}

TEST(EditDistance, CountsEdits) {
  EXPECT_EQ(editDistance("kitten", "sitting"), 3u);
  EXPECT_EQ(editDistance("", "abc"), 3u);
  EXPECT_EQ(editDistance("same", "same"), 0u);
}

TEST_F(SettingsTest, TheFirstPartOfExpertNamesMayBeLeftOut) {
  double radius_px = 3.0;
  settings_.bind("expert.front_end.blur.radius_px", &radius_px, "blur");
  settings_.set("expert.front_end.blur.radius_px", "4");
  EXPECT_EQ(radius_px, 4.0);
  settings_.set("front_end.blur.radius_px", "5");
  EXPECT_EQ(radius_px, 5.0);
  settings_.load(file("front_end:\n  max_features: 7\n  blur: {radius_px: 6}\n"));
  EXPECT_EQ(radius_px, 6.0);
  EXPECT_EQ(max_features_, 7);
  settings_.load(file("expert: {front_end: {blur: {radius_px: 8}}}\n"));
  EXPECT_EQ(radius_px, 8.0);
  std::ostringstream written;
  settings_.write(written);
  EXPECT_THAT(written.str(), HasSubstr("expert:\n  front_end:\n    blur:\n"));
  EXPECT_THROW(settings_.bind("front_end.blur.radius_px", &radius_px, "again"), std::logic_error);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/magnetometer/calibration/currents/current_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>
#include <fstream>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/magnetometer/currents/test_still_test.h"

// A still test through a source of readings, as the program reads it.

namespace lodeline {
namespace {

using test::makeStillTest;
using test::StillTestOptions;
using ::testing::HasSubstr;

class StillSource final : public MeasurementSource {
 public:
  explicit StillSource(StillTest test) : test_(std::move(test)) {
    rig_.magnetometer.emplace();
    rig_.currents.emplace();
    rig_.currents->channels = test_.channels;
  }
  const Rig& rig() const override { return rig_; }
  Rig& changeRig() { return rig_; }
  std::optional<ImuSample> nextImu() override { return next(test_.imu, &imu_); }
  std::optional<PendingImage> nextImage(size_t) override { return std::nullopt; }
  std::optional<MagnetometerSample> nextMagnetometer() override {
    return next(test_.magnetometer, &magnetometer_);
  }
  std::optional<CurrentSample> nextCurrents() override { return next(test_.currents, &currents_); }

 private:
  template <typename Sample>
  static std::optional<Sample> next(const std::vector<Sample>& samples, size_t* at) {
    return *at < samples.size() ? std::optional(samples[(*at)++]) : std::nullopt;
  }

  StillTest test_;
  Rig rig_;
  size_t imu_ = 0, magnetometer_ = 0, currents_ = 0;
};

StillTest read(StillSource source, Diagnostics* diagnostics) {
  return readStillTest(source, "test", true, {}, std::nullopt, diagnostics);
}

TEST(CalibrateCurrents, WritesARigFileThatKeepsTheFields) {
  test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "mag.yaml";
  StillTestOptions options;
  options.lag_s = 0.1;
  Diagnostics diagnostics;
  const CurrentCalibrationResult result =
      calibrateCurrents(read(StillSource(makeStillTest(options)), &diagnostics), std::nullopt, &diagnostics);
  writeCurrentFile(result, file);
  const CurrentCalibration again = readCurrentFile(file);
  EXPECT_EQ(again.channels, result.calibration.channels);
  ASSERT_EQ(again.fields_T_per_A.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(again.fields_T_per_A[i], result.calibration.fields_T_per_A[i]);
    EXPECT_LT((again.fields_T_per_A[i] - options.fields_T_per_A[i]).norm(), 0.02e-6);
  }
  EXPECT_EQ(again.field_sigma_T_per_A, result.calibration.field_sigma_T_per_A);
  EXPECT_NEAR(again.time_offset_to_imu_s, 0.1, 0.01);
}

TEST(CalibrateCurrents, ReportsResidualsSharesAndMovedCables) {
  Diagnostics diagnostics;
  const CurrentCalibrationResult first =
      calibrateCurrents(read(StillSource(makeStillTest({})), &diagnostics), std::nullopt, &diagnostics);
  EXPECT_THAT(currentText(first), HasSubstr("without compensation"));
  EXPECT_THAT(currentText(first), HasSubstr("motor_3"));
  StillTestOptions moved;
  moved.seed = 2;
  moved.fields_T_per_A[1] = -moved.fields_T_per_A[1];
  const CurrentCalibrationResult second = calibrateCurrents(
      read(StillSource(makeStillTest(moved)), &diagnostics), first.calibration, &diagnostics);
  EXPECT_EQ(diagnostics.count("current_compensation_wrong"), 1);
  EXPECT_THAT(currentText(second), HasSubstr("Cables moved: do not use"));
  const nlohmann::json json = currentJson(second);
  EXPECT_TRUE(json["check"]["cables_moved"]);
  EXPECT_GT(json["without_compensation"]["rms_T"], 10.0 * json["with_compensation"]["rms_T"].get<double>());
  EXPECT_THAT(currentFigure(second).commands, HasSubstr("motor_4"));
}

TEST(CalibrateCurrents, RefusesARecordingWithoutCurrents) {
  Diagnostics diagnostics;
  StillSource source(makeStillTest({}));
  source.changeRig().currents.reset();
  EXPECT_THROW(read(source, &diagnostics), InputError);
  StillTest still = makeStillTest({});
  still.currents[7].currents_A.pop_back();
  EXPECT_THROW(read(StillSource(still), &diagnostics), InputError);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/io/synchronizer/thinned_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <deque>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::DoubleNear;
using ::testing::Pointwise;

class ImagesAt : public RecordedSource {
 public:
  explicit ImagesAt(std::vector<std::deque<double>> times_s)
      : RecordedSource(Rig()), times_s_(std::move(times_s)) {
    for (size_t i = 0; i < times_s_.size(); ++i) {
      rig_.cameras.emplace_back();
      rig_.cameras.back().rate_hz = 10.0;
    }
  }
  std::optional<ImuSample> nextRecordedImu() override { return std::nullopt; }
  std::optional<PendingImage> nextImage(size_t camera) override {
    std::deque<double>& times = times_s_[camera];
    if (times.empty()) return std::nullopt;
    const double time_s = times.front();
    times.pop_front();
    return PendingImage{Time::fromSeconds(time_s), "", {}};
  }

 private:
  std::vector<std::deque<double>> times_s_;
};

std::vector<double> timesOf(RecordedSource* source, size_t camera) {
  std::vector<double> times_s;
  while (const auto image = source->nextImage(camera)) times_s.push_back(image->time.seconds());
  return times_s;
}

auto areTimes(const std::vector<double>& times_s) { return Pointwise(DoubleNear(1e-6), times_s); }

TEST(ThinnedSource, TakesEverySecondImageAndStatesTheRate) {
  const auto source = everyNthImage(
      std::make_unique<ImagesAt>(std::vector<std::deque<double>>{{1.0, 1.1, 1.2, 1.3, 1.4}}), 2);
  EXPECT_DOUBLE_EQ(source->rig().cameras[0].rate_hz, 5.0);
  EXPECT_THAT(timesOf(source.get(), 0), areTimes({1.0, 1.2, 1.4}));
}

TEST(ThinnedSource, KeepsPairsWhereOneCameraLosesAnImage) {
  const auto source =
      everyNthImage(std::make_unique<ImagesAt>(std::vector<std::deque<double>>{
                        {1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6}, {1.001, 1.101, 1.301, 1.401, 1.6}}),
                    2);
  EXPECT_THAT(timesOf(source.get(), 0), areTimes({1.0, 1.2, 1.4, 1.6}));
  EXPECT_THAT(timesOf(source.get(), 1), areTimes({1.001, 1.401, 1.6}));
}

TEST(ThinnedSource, FollowsARateThatIsNotTheStatedOne) {
  std::deque<double> times_s;
  for (int i = 0; i < 200; ++i) times_s.push_back(i / 9.7);  // the rate is stated as 10 Hz
  const auto source = everyNthImage(std::make_unique<ImagesAt>(std::vector<std::deque<double>>{times_s}), 2);
  EXPECT_EQ(timesOf(source.get(), 0).size(), 100U);
}

TEST(ThinnedSource, RefusesAStepBelowOne) {
  EXPECT_THROW(everyNthImage(std::make_unique<ImagesAt>(std::vector<std::deque<double>>{{1.0}}), 0),
               UsageError);
}

}  // namespace
}  // namespace lodeline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>

#include "lodeline/inspection/inspection.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// An IMU at 200 Hz and a camera at 20 Hz with blank images, for the given seconds from 100 s on. A second
/// camera where it has images.
struct Stamps {
  std::vector<Time> imu, images, second_images;
  explicit Stamps(double seconds = 10.0) {
    for (int i = 0; i < static_cast<int>(200 * seconds); ++i) imu.push_back(at(0.005 * i));
    for (int i = 0; i < static_cast<int>(20 * seconds); ++i) images.push_back(at(0.05 * i));
  }
  static Time at(double s) { return Time::fromSeconds(100.0 + s); }
};

class StampSource : public MeasurementSource {
 public:
  explicit StampSource(Stamps stamps) : stamps_(std::move(stamps)) {
    rig_.cameras.emplace_back();
    rig_.cameras.front().name = "cam0";
    rig_.cameras.front().width_px = 32;
    rig_.cameras.front().height_px = 32;
    rig_.cameras.front().fx_px = rig_.cameras.front().fy_px = 40.0;
    rig_.cameras.front().cx_px = rig_.cameras.front().cy_px = 15.5;
    if (stamps_.second_images.empty()) return;
    rig_.cameras.push_back(rig_.cameras.front());
    rig_.cameras.back().name = "cam1";
    rig_.cameras.back().body_from_camera.translation.x() = 0.1;
  }
  const Rig& rig() const override { return rig_; }
  std::optional<ImuSample> nextImu() override {
    if (imu_ == stamps_.imu.size()) return std::nullopt;
    const auto k = static_cast<double>(imu_);
    const ImuSample sample{stamps_.imu[imu_++], Vec3(0.01 * std::sin(k), 0.01 * std::sin(1.1 * k), 0.01),
                           Vec3(0.1 * std::sin(1.3 * k), 0.1 * std::sin(0.7 * k), 9.8)};
    return sample;
  }
  std::optional<PendingImage> nextImage(size_t camera) override {
    const std::vector<Time>& images = camera == 0 ? stamps_.images : stamps_.second_images;
    size_t& image = image_[camera];
    if (image == images.size()) return std::nullopt;
    const Time time = images[image];
    return PendingImage{time, "image " + std::to_string(image++), [] {
                          return LoadedImage{cv::Mat(32, 32, CV_8UC1, cv::Scalar(90)), ""};
                        }};
  }

 private:
  Stamps stamps_;
  Rig rig_;
  size_t imu_ = 0;
  std::array<size_t, 2> image_ = {0, 0};
};

Inspection inspected(const Stamps& stamps) {
  return inspect([&](Diagnostics*) { return std::make_unique<StampSource>(stamps); }, {});
}

const InspectionFinding* find(const Inspection& inspection, const std::string& kind) {
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.kind == kind) return &finding;
  }
  return nullptr;
}

TEST(StampFindings, HealthyStampsHaveNone) {
  const Inspection inspection = inspected(Stamps());
  for (const char* kind :
       {"clocks_apart", "imu_bursts", "imu_clock_jump", "image_clock_jump", "stamps_out_of_order", "gaps"})
    EXPECT_EQ(find(inspection, kind), nullptr) << kind;
  EXPECT_NEAR(inspection.imu.stream.rate_hz, 200.0, 1e-6);
}

TEST(StampFindings, ClocksThatDoNotMeetComeFirst) {
  Stamps stamps;
  for (Time& time : stamps.imu) time = time - Duration::fromSeconds(90.0);
  const Inspection inspection = inspected(stamps);
  ASSERT_FALSE(inspection.findings.empty());
  EXPECT_EQ(inspection.findings.front().kind, "clocks_apart");
  EXPECT_THAT(inspection.findings.front().message,
              AllOf(HasSubstr("cam0 and imu0 have no time in common"), HasSubstr("from 100000000000 to"),
                    HasSubstr("from 10000000000 to"), HasSubstr("80.005 s earlier")));
}

TEST(StampFindings, ASecondCameraByAnotherClockIsComparedWithTheFirst) {
  Stamps stamps;
  stamps.second_images = stamps.images;
  EXPECT_EQ(find(inspected(stamps), "clocks_apart"), nullptr);
  for (Time& time : stamps.second_images) time = time + Duration::fromSeconds(3600.0);
  const Inspection inspection = inspected(stamps);
  ASSERT_NE(find(inspection, "clocks_apart"), nullptr);
  EXPECT_THAT(find(inspection, "clocks_apart")->message,
              AllOf(HasSubstr("cam1 and cam0 have no time in common"),
                    HasSubstr("(3600 s from first to first)"), HasSubstr("timeshift_cam_imu")));
}

TEST(StampFindings, BurstsAreNamedWithTheirMeanRate) {
  Stamps stamps;
  for (size_t i = 0; i < stamps.imu.size(); ++i) {
    const size_t last = std::min(i / 10 * 10 + 9, stamps.imu.size() - 1);
    stamps.imu[i] = Stamps::at(0.005 * static_cast<double>(last) - 1e-4 * static_cast<double>(last - i));
  }
  const Inspection inspection = inspected(stamps);
  ASSERT_NE(find(inspection, "imu_bursts"), nullptr);
  EXPECT_THAT(find(inspection, "imu_bursts")->message, HasSubstr("200 Hz"));
  EXPECT_EQ(find(inspection, "gaps"), nullptr);
  EXPECT_NEAR(inspection.imu.stream.rate_hz, 200.0, 1.0);
  ASSERT_EQ(inspection.imu.samples.size(), stamps.imu.size());
  for (size_t i = 20; i < stamps.imu.size(); ++i)
    ASSERT_NEAR((inspection.imu.samples[i].time - Stamps::at(0.0)).seconds(), 0.005 * static_cast<double>(i),
                1e-4);
}

TEST(StampFindings, AClockSetBackIsNotCalledDisorder) {
  Stamps stamps;
  for (size_t i = 1000; i < stamps.imu.size(); ++i)
    stamps.imu[i] = stamps.imu[i] - Duration::fromSeconds(0.7);
  for (size_t i = 100; i < stamps.images.size(); ++i)
    stamps.images[i] = stamps.images[i] - Duration::fromSeconds(0.7);
  const Inspection inspection = inspected(stamps);
  for (const char* kind : {"imu_clock_jump", "image_clock_jump"}) {
    ASSERT_NE(find(inspection, kind), nullptr) << kind;
    EXPECT_THAT(find(inspection, kind)->message, HasSubstr("set back by 0.7 s"));
  }
  EXPECT_EQ(find(inspection, "stamps_out_of_order"), nullptr);
}

}  // namespace
}  // namespace lodeline

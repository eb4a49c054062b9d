#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "lodeline/frontend/front_end.h"
#include "lodeline/frontend/stereo/triangulation.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

/// True body poses by time, TUM rows `t px py pz qx qy qz qw`.
class Truth {
 public:
  explicit Truth(const std::filesystem::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
      std::istringstream row(line);
      double t = 0.0;
      Vec3 p;
      Quat q;
      if (row >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w()) {
        poses_[t] = Rigid3(q.normalized(), p);
      }
    }
  }
  bool empty() const { return poses_.empty(); }

  Rigid3 at(Time time) const {
    const auto after = poses_.lower_bound(time.seconds());
    const auto before = std::prev(after);
    const double share = (time.seconds() - before->first) / (after->first - before->first);
    return {before->second.rotation.slerp(share, after->second.rotation),
            (1.0 - share) * before->second.translation + share * after->second.translation};
  }

 private:
  std::map<double, Rigid3> poses_;
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

class Mh01Tracks : public testing::Test {
 protected:
  void SetUp() override {
    const std::optional<std::filesystem::path> recording = testData(kMh01Recording);
    if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
    data_ = *recording;
    trackAll();
  }

  /// The predicted rotation uses the gyroscope without bias correction, as at the start of every run.
  void trackAll() {
    EurocSource source(data_, {}, &diagnostics_);
    Synchronizer synchronizer(&source, {}, &diagnostics_);
    rig_ = source.rig();
    FrontEnd front_end(rig_, {});
    while (const auto packet = synchronizer.next()) {
      Quat rotation = Quat::Identity();
      for (size_t i = 1; i < packet->imu.size() && !frames_.empty(); ++i) {
        const double dt = (packet->imu[i].time - packet->imu[i - 1].time).seconds();
        rotation = rotation * so3::exp(dt * packet->imu[i - 1].angular_velocity_B);
      }
      frames_.push_back(front_end.process(packet->time, packet->images, rotation));
    }
    for (size_t i = 0; i < frames_.size(); ++i) {
      for (const FeatureObservation& o : frames_[i].observations) {
        if (o.camera == 0) tracks_[o.track].push_back({i, o.bearing_C});
      }
    }
  }

  struct Observation {
    size_t frame;
    Vec3 bearing_C;
  };
  std::filesystem::path data_;
  Diagnostics diagnostics_;
  Rig rig_;
  std::vector<FrameTracks> frames_;
  std::map<TrackId, std::vector<Observation>> tracks_;
};

TEST_F(Mh01Tracks, AreManyAndLongLived) {
  ASSERT_EQ(frames_.size(), 288u);
  double observed = 0.0, survived = 0.0, started = 0.0;
  for (const auto& [id, observations] : tracks_) {
    observed += static_cast<double>(observations.size());
    for (const Observation& observation : observations) {
      if (observation.frame + 10 >= frames_.size()) continue;
      started += 1.0;
      survived += observations.back().frame >= observation.frame + 10 ? 1.0 : 0.0;
    }
  }
  EXPECT_GT(observed / static_cast<double>(frames_.size()), 240.0);
  EXPECT_GT(survived / started, 0.6);
}

TEST_F(Mh01Tracks, LieOnTheEpipolarLinesOfTheStereoPair) {
  const Rigid3 second_from_first =
      rig_.cameras[1].body_from_camera.inverse() * rig_.cameras[0].body_from_camera;
  std::vector<double> errors_px;
  for (const FrameTracks& frame : frames_) {
    for (size_t i = 1; i < frame.observations.size(); ++i) {
      if (frame.observations[i].camera != 1) continue;
      const Vec3 normal = second_from_first.translation.cross(second_from_first.rotation *
                                                              frame.observations[i - 1].bearing_C);
      errors_px.push_back(rig_.cameras[1].fx_px *
                          std::abs(normal.normalized().dot(frame.observations[i].bearing_C)));
    }
  }
  EXPECT_GT(static_cast<double>(errors_px.size()) / 287.0, 140.0);
  EXPECT_LT(median(errors_px), 0.25);
}

TEST_F(Mh01Tracks, AgreeWithTheTruePoses) {
  const Truth truth(data_ / "mav0" / "state_groundtruth_estimate0" / "gt_tum.txt");
  ASSERT_FALSE(truth.empty());
  const double focal_px = rig_.cameras[0].fx_px;
  // The last of these includes the attitude error of the reference itself.
  for (const auto& [length, bar_px] : std::map<size_t, double>{{2, 0.12}, {10, 0.4}, {20, 0.7}}) {
    std::vector<double> residuals_px;
    for (const auto& [id, observations] : tracks_) {
      for (size_t first = 0; first + length < observations.size(); first += length) {
        std::vector<BearingView> views;
        for (size_t i = first; i <= first + length; ++i) {
          views.push_back({truth.at(frames_[observations[i].frame].time) * rig_.cameras[0].body_from_camera,
                           observations[i].bearing_C, 1.0 / focal_px});
        }
        residuals_px.push_back(triangulate(views).rms_sigmas);
      }
    }
    EXPECT_GT(residuals_px.size(), 1500u);
    EXPECT_LT(median(residuals_px), bar_px) << length << " frames";
  }
}

}  // namespace
}  // namespace lodeline

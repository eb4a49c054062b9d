#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/mapping/recognition/descriptor_index.h"
#include "lodeline/mapping/recognition/loop_verifier.h"
#include "lodeline/mapping/recognition/merge_keyframes.h"
#include "lodeline/mapping/recognition/test_described_frames.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/files/test_data.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

/// The cameras of EuRoC's rig, by the files beside the image pairs.
Rig eurocRig() {
  const auto camera = [](const char* name, double fx, double fy, double cx, double cy,
                         std::vector<double> distortion, const Eigen::Matrix4d& body_from_camera) {
    CameraCalibration c;
    c.name = name;
    c.width_px = 752;
    c.height_px = 480;
    c.fx_px = fx;
    c.fy_px = fy;
    c.cx_px = cx;
    c.cy_px = cy;
    c.model = "radial-tangential";
    c.distortion = std::move(distortion);
    c.body_from_camera = Rigid3::fromMatrix(body_from_camera, name);
    return c;
  };
  Eigen::Matrix4d left, right;
  left << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975, 0.999557249008,
      0.0149672133247, 0.025715529948, -0.064676986768, -0.0257744366974, 0.00375618835797, 0.999660727178,
      0.00981073058949, 0.0, 0.0, 0.0, 1.0;
  right << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556, 0.999598781151,
      0.0130119051815, 0.0251588363115, 0.0453689425024, -0.0253898008918, 0.0179005838253, 0.999517347078,
      0.00786212447038, 0.0, 0.0, 0.0, 1.0;
  Rig rig;
  rig.cameras = {camera("left", 458.654, 457.296, 367.215, 248.375,
                        {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}, left),
                 camera("right", 457.587, 456.134, 379.999, 255.238,
                        {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05}, right)};
  return rig;
}

class LoopPairs : public testing::Test {
 protected:
  std::vector<MapKeyframe> keyframes_;
  std::vector<Rigid3> truth_;

  void SetUp() override {
    const auto folder = testData("loop_pairs");
    if (!folder) GTEST_SKIP() << missingTestData("loop_pairs");
    // Body poses of EuRoC V1_01_easy at the times of the images.
    truth_ = {{Quat(0.338337, 0.608466, -0.535476, 0.478082).normalized(), {1.573832, 2.023348, 1.738755}},
              {Quat(0.478634, 0.415595, -0.700197, 0.328505).normalized(), {1.872115, 1.786064, 1.586159}},
              {Quat(0.3394, -0.672895, -0.492724, -0.435018).normalized(), {-0.662997, -0.495046, 1.347300}},
              {Quat(0.39266, -0.590667, -0.58023, -0.400326).normalized(), {-0.345638, -0.501712, 1.320441}}};
    for (size_t i = 0; i < truth_.size(); ++i) {
      const auto image = [&](const char* side) {
        return cv::imread((*folder / fmt::format("{}_img_{}.png", side, i)).string(), cv::IMREAD_GRAYSCALE);
      };
      // Only roll and pitch are used. Of the matches between the pairs 0 and 1, 104 of 127 agree on a tilt
      // that differs from this truth by 1.9 degrees. It is not known which of both is wrong.
      keyframes_.push_back(keyframeOfImages(eurocRig(), {image("left"), image("right")}, truth_[i], 0.02));
      keyframes_.back().id = static_cast<KeyframeId>(i);
    }
  }
  Loop verify(size_t a, size_t b) const { return LoopVerifier().verify(keyframes_[a], keyframes_[b]); }
  double errorOf_m(const Loop& loop) const {
    const Rigid3 truth = truth_[static_cast<size_t>(loop.old_keyframe)].inverse() *
                         truth_[static_cast<size_t>(loop.new_keyframe)];
    return (truth.translation - loop.old_from_new.translation).norm();
  }
};

TEST_F(LoopPairs, OfOnePlaceAreVerified) {
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 0), std::pair(2, 3), std::pair(3, 2)}) {
    const Loop loop = verify(static_cast<size_t>(a), static_cast<size_t>(b));
    ASSERT_EQ(loop.status, LoopStatus::Verified) << a << " " << b << ": " << loop.reason;
    EXPECT_LT(errorOf_m(loop), 0.1);
  }
}

TEST_F(LoopPairs, OfTwoPlacesAreRefused) {
  for (const size_t a : {0U, 1U}) {
    for (const size_t b : {2U, 3U}) {
      EXPECT_NE(verify(a, b).status, LoopStatus::Verified);
      EXPECT_NE(verify(b, a).status, LoopStatus::Verified);
    }
  }
}

/// True body poses by time, TUM rows `t px py pz qx qy qz qw`.
std::map<double, Rigid3> readTruth(const std::filesystem::path& file) {
  std::map<double, Rigid3> poses;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream row(line);
    double t = 0.0;
    Vec3 p;
    Quat q;
    if (row >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w())
      poses[t] = Rigid3(q.normalized(), p);
  }
  return poses;
}

TEST(Mh01Relocalisation, FindsClipsOfTheEndInAMapOfTheStart) {
  const auto recording = testData(kMh01Recording);
  if (!recording) GTEST_SKIP() << missingTestData(kMh01Recording);
  Diagnostics diagnostics;
  EurocSource source(*recording, {}, &diagnostics);
  Synchronizer synchronizer(&source, {}, &diagnostics);
  PacketOdometry odometry(source.rig(), {}, &diagnostics);
  const KeyframeDescriber describer(source.rig());
  std::vector<MapKeyframe> keyframes;
  constexpr int kEvery = 5;  // a keyframe each 0.25 s
  double describing_s = 0.0;
  int frame = 0;
  while (auto packet = synchronizer.next()) {
    const FrameEstimate estimate = odometry.add(*packet);
    if (estimate.status == Status::Waiting || frame++ % kEvery != 0) continue;
    const double before_s = threadSeconds();
    keyframes.push_back(describer.describe(packet->images, odometry.tracks(), estimate, odometry.estimator(),
                                           odometry.frontEnd().fixedStructures()[0].mask()));
    describing_s += threadSeconds() - before_s;
    keyframes.back().id = static_cast<KeyframeId>(keyframes.size()) - 1;
  }
  ASSERT_GT(keyframes.size(), 40u);

  const auto truth = readTruth(*recording / "mav0/state_groundtruth_estimate0/gt_tum.txt");
  const auto trueBody = [&](const MapKeyframe& keyframe) {
    const auto after = truth.lower_bound(keyframe.time.seconds());
    const auto before = std::prev(after);
    const double share = (keyframe.time.seconds() - before->first) / (after->first - before->first);
    return Rigid3(before->second.rotation.slerp(share, after->second.rotation),
                  (1.0 - share) * before->second.translation + share * after->second.translation);
  };
  const auto since_s = [&](const MapKeyframe& keyframe) {
    return (keyframe.time - keyframes.front().time).seconds();
  };
  const double length_s = since_s(keyframes.back());
  DescriptorIndex index;
  for (const MapKeyframe& keyframe : keyframes)
    if (since_s(keyframe) <= 6.0) index.add(keyframe);

  constexpr size_t kClip = 5;  // 1 s
  const LoopVerifier verifier;
  int clips = 0, found = 0, wrong = 0, verified = 0, examined = 0;
  double worst_m = 0.0, verifying_s = 0.0, nees = 0.0;
  for (size_t last = kClip; last < keyframes.size(); ++last) {
    if (since_s(keyframes[last - kClip + 1]) < length_s - 6.0) continue;
    const MapKeyframe clip = mergeKeyframes(std::span(keyframes).subspan(last + 1 - kClip, kClip));
    ++clips;
    bool is_found = false;
    for (const SimilarKeyframe& similar : index.query(clip, 5)) {
      const MapKeyframe& old_keyframe = keyframes[static_cast<size_t>(similar.id)];
      const double before_s = threadSeconds();
      const Loop loop = verifier.verify(old_keyframe, clip);
      verifying_s += threadSeconds() - before_s;
      ++examined;
      const Rigid3 expected = trueBody(old_keyframe).inverse() * trueBody(clip);
      const double error_m = (expected.translation - loop.old_from_new.translation).norm();
      if (loop.status != LoopStatus::Verified) continue;
      ++verified;
      is_found = true;
      worst_m = std::max(worst_m, error_m);
      Eigen::Matrix<double, 6, 1> error;
      error << expected.translation - loop.old_from_new.translation,
          so3::log(expected.rotation * loop.old_from_new.rotation.conjugate());
      nees += error.dot(loop.covariance.ldlt().solve(error));
      wrong += error_m > 0.1 || expected.rotation.angularDistance(loop.old_from_new.rotation) > 2.0 * kDegree
                   ? 1
                   : 0;
    }
    found += is_found ? 1 : 0;
  }
  std::printf(
      "clips %d, found %d, verified %d of %d, worst %.4f m, nees %.1f; %.1f ms to describe, %.1f to verify\n",
      clips, found, verified, examined, worst_m, nees / verified,
      1e3 * describing_s / static_cast<double>(keyframes.size()), 1e3 * verifying_s / examined);
  ASSERT_GT(clips, 10);
  EXPECT_GE(found, 0.9 * clips);
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(worst_m, 0.02);
  // The truth has errors of some millimetres and a tenth of a degree too.
  EXPECT_LT(nees / verified, 12.0);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/frontend/front_end.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/draw_tracks.h"
#include "lodeline/frontend/test_accuracy.h"
#include "lodeline/frontend/test_sequence.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr int kFrames = 14;

/// A sequence with its images, rendered once for all tests.
struct Recording {
  Recording(const TestLight& light, double speed_m_per_s) : sequence(light, speed_m_per_s) {
    for (int i = 0; i < kFrames; ++i) images.push_back(sequence.images(i));
  }
  Quat previousFromCurrent(int frame) const {
    return frame == 0 ? Quat::Identity() : sequence.previousFromCurrent(frame);
  }
  TestSequence sequence;
  std::vector<std::vector<cv::Mat>> images;
};

const Recording& daylight() {
  static const Recording kRecording(TestLight::daylight(), 0.3);
  return kRecording;
}

std::vector<FrameTracks> track(const Recording& recording, FrontEnd& front_end) {
  std::vector<FrameTracks> result;
  for (int i = 0; i < kFrames; ++i) {
    result.push_back(front_end.process(TestSequence::time(i), recording.images[static_cast<size_t>(i)],
                                       recording.previousFromCurrent(i)));
  }
  return result;
}

std::map<TrackId, Vec2> pixels(const FrameTracks& frame, int camera) {
  std::map<TrackId, Vec2> result;
  for (const FeatureObservation& observation : frame.observations) {
    if (observation.camera == camera) result[observation.track] = observation.pixel;
  }
  return result;
}

TrackAccuracy accuracyIn(const TestLight& light, double speed_m_per_s) {
  const Recording recording(light, speed_m_per_s);
  FrontEnd front_end(recording.sequence.rig(), {});
  return accuracyOverTenFrames(recording.sequence, track(recording, front_end));
}

TEST(FrontEnd, FollowsAWallInDaylight) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  const TrackAccuracy accuracy = accuracyOverTenFrames(daylight().sequence, track(daylight(), front_end));
  EXPECT_GE(accuracy.survived, 210);
  EXPECT_LT(accuracy.bias_px.norm(), 0.01);
  EXPECT_LT(accuracy.rms_px, 0.06);
  EXPECT_EQ(front_end.statistics().image.word, "good");
}

TEST(FrontEnd, IsNotDraggedAlongByTheLampInADimPicture) {
  const TrackAccuracy accuracy = accuracyIn(TestLight::dimLamp(), 0.3);
  EXPECT_GE(accuracy.survived, 150);
  EXPECT_LT(accuracy.bias_px.norm(), 0.05);
  EXPECT_LT(accuracy.rms_px, 0.45);
}

TEST(FrontEnd, SmoothsMoreWhereNoiseIsStrong) {
  TestLight light = TestLight::daylight();
  light.texture_contrast = 0.12;
  light.noise_grey = 6.0;
  const Recording recording(light, 0.3);
  const auto accuracy = [&](const FrontEndOptions& options) {
    FrontEnd front_end(recording.sequence.rig(), options);
    return accuracyOverTenFrames(recording.sequence, track(recording, front_end));
  };
  const TrackAccuracy usual = accuracy({});
  FrontEndOptions options;
  options.noisy_sharpness = 1.0;
  const TrackAccuracy rough = accuracy(options);
  EXPECT_GT(usual.survived, 3.0 * rough.survived);
  EXPECT_LT(usual.bias_px.norm(), 0.15);
  EXPECT_LT(usual.rms_px, 0.7);
}

TEST(FrontEnd, IsNotDraggedAlongByTheLampInMilkyWater) {
  const TrackAccuracy accuracy = accuracyIn(TestLight::hazyLamp(), 0.3);
  EXPECT_GE(accuracy.survived, 130);
  EXPECT_LT(accuracy.bias_px.norm(), 0.1);
  EXPECT_LT(accuracy.rms_px, 0.5);
}

TEST(FrontEnd, StandsStillWithTheCamera) {
  const TrackAccuracy accuracy = accuracyIn(TestLight::daylight(), 0.0);
  EXPECT_GE(accuracy.survived, 245);
  EXPECT_LT(accuracy.bias_px.norm(), 0.005);
  EXPECT_LT(accuracy.rms_px, 0.05);
}

TEST(FrontEnd, MatchesAcrossTheStereoPair) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  const std::vector<FrameTracks> frames = track(daylight(), front_end);
  for (int i = 0; i < kFrames; i += 6) {
    const FrameTracks& frame = frames[static_cast<size_t>(i)];
    const auto left = pixels(frame, 0), right = pixels(frame, 1);
    EXPECT_GE(right.size(), 190u);
    std::vector<double> errors;
    for (const auto& [id, pixel] : right) {
      ASSERT_TRUE(left.contains(id));
      errors.push_back((pixel - *daylight().sequence.truePixel(i, 0, left.at(id), i, 1)).norm());
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.06);
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.2);
  }
}

// Half a degree across the epipolar lines puts every match beyond the limit.
TEST(FrontEnd, MatchesACameraThatIsTurnedAgainstItsFile) {
  const Vec3 turn = 0.5 * kDegree * Vec3(1.0, 0.0, 1.0);
  Rig rig = daylight().sequence.rig();
  const Rigid3 camera0 = rig.cameras[0].body_from_camera;
  Quat& rotation = rig.cameras[1].body_from_camera.rotation;
  rotation = camera0.rotation * so3::exp(-turn) * camera0.rotation.conjugate() * rotation;
  FrontEnd front_end(rig, {});
  const std::vector<FrameTracks> frames = track(daylight(), front_end);
  EXPECT_GE(pixels(frames.front(), 1).size(), 150u);
  EXPECT_GE(pixels(frames.back(), 1).size(), 190u);
  ASSERT_EQ(frames.back().camera_rotations.size(), 1u);
  const Vec3 found = frames.back().camera_rotations.front();
  EXPECT_NEAR(found.x(), turn.x(), 0.03 * kDegree);
  EXPECT_NEAR(found.z(), turn.z(), 0.1 * kDegree);

  FrontEndOptions believing;
  believing.stereo.learn_rotation = false;
  FrontEnd lost(rig, believing);
  EXPECT_LT(pixels(track(daylight(), lost).back(), 1).size(), 50u);
}

TEST(FrontEnd, BelievesARightFile) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  for (const FrameTracks& frame : track(daylight(), front_end))
    EXPECT_TRUE(frame.camera_rotations.front().isZero());
}

TEST(FrontEnd, KeepsItsPromiseOnTheOutput) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  std::set<TrackId> ended;
  std::set<TrackId> before;
  for (const FrameTracks& frame : track(daylight(), front_end)) {
    std::set<TrackId> now;
    for (size_t i = 0; i < frame.observations.size(); ++i) {
      const FeatureObservation& o = frame.observations[i];
      EXPECT_NEAR(o.bearing_C.norm(), 1.0, 1e-12);
      const auto& camera = front_end.cameras()[static_cast<size_t>(o.camera)];
      EXPECT_LT((*camera->project(o.bearing_C) - o.pixel).norm(), 1e-6);
      EXPECT_FALSE(ended.contains(o.track)) << "identifier used again";
      now.insert(o.track);
      if (i == 0) continue;
      const FeatureObservation& last = frame.observations[i - 1];
      EXPECT_LT(std::make_pair(last.track, last.camera), std::make_pair(o.track, o.camera));
    }
    std::set_difference(before.begin(), before.end(), now.begin(), now.end(),
                        std::inserter(ended, ended.end()));
    before = now;
  }
}

TEST(FrontEnd, RepeatsItselfExactly) {
  FrontEnd first(daylight().sequence.rig(), {}), second(daylight().sequence.rig(), {});
  const std::vector<FrameTracks> a = track(daylight(), first), b = track(daylight(), second);
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].observations.size(), b[i].observations.size());
    for (size_t j = 0; j < a[i].observations.size(); ++j) {
      EXPECT_EQ(a[i].observations[j].track, b[i].observations[j].track);
      EXPECT_EQ(a[i].observations[j].pixel, b[i].observations[j].pixel);
    }
  }
}

TEST(FrontEnd, GivesMonocularObservationsWithoutTheRightImage) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  Recording recording = daylight();
  recording.images[5][1] = cv::Mat();
  const std::vector<FrameTracks> frames = track(recording, front_end);
  EXPECT_GT(pixels(frames[5], 0).size(), 230u);
  EXPECT_TRUE(pixels(frames[5], 1).empty());
  EXPECT_GT(pixels(frames[6], 1).size(), 190u);
}

TEST(FrontEnd, WorksWithOneCamera) {
  Rig rig = daylight().sequence.rig();
  rig.cameras.resize(1);
  Recording recording = daylight();
  for (auto& images : recording.images) images.resize(1);
  FrontEnd front_end(rig, {});
  EXPECT_GE(accuracyOverTenFrames(recording.sequence, track(recording, front_end)).survived, 210);
}

TEST(FrontEnd, FindsTracksAgainAfterMissingImages) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  Recording recording = daylight();
  for (const size_t i : {6u, 7u, 8u}) recording.images[i][0] = cv::Mat();
  const std::vector<FrameTracks> frames = track(recording, front_end);
  EXPECT_TRUE(frames[7].observations.empty());
  const auto before = pixels(frames[5], 0), after = pixels(frames[9], 0);
  const auto again = std::count_if(before.begin(), before.end(),
                                   [&](const auto& entry) { return after.contains(entry.first); });
  EXPECT_GE(again, 180);
}

TEST(FrontEnd, StartsAnewAfterALongSilence) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  const auto first = front_end.process(Time::fromSeconds(10.0), daylight().images[0], Quat::Identity());
  const auto later = front_end.process(Time::fromSeconds(12.0), daylight().images[0], Quat::Identity());
  EXPECT_GT(later.observations.front().track, first.observations.back().track);
}

TEST(FrontEnd, KeepsItsTracksThroughJumpsOfTheExposure) {
  // With more light the bright parts of this image saturate, which moves points tracked by their edges.
  for (const double gain : {0.4, 1.3}) {
    FrontEnd front_end(daylight().sequence.rig(), {});
    Recording recording = daylight();
    for (size_t i = 7; i < kFrames; ++i) {
      for (cv::Mat& image : recording.images[i]) {
        cv::Mat exposed;
        image.convertTo(exposed, -1, gain);
        image = exposed;
      }
    }
    const std::vector<FrameTracks> frames = track(recording, front_end);
    const auto before = pixels(frames[6], 0), after = pixels(frames[8], 0);
    const auto kept = std::count_if(before.begin(), before.end(),
                                    [&](const auto& entry) { return after.contains(entry.first); });
    EXPECT_GE(kept, 180) << "gain " << gain;
    EXPECT_LT(accuracyOverTenFrames(recording.sequence, frames).rms_px, 0.2) << "gain " << gain;
  }
}

TEST(FrontEnd, LosesEverythingInDarknessAndRecovers) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  Recording recording = daylight();
  for (cv::Mat& image : recording.images[4]) image = cv::Mat(image.size(), CV_8U, cv::Scalar(0));
  const std::vector<FrameTracks> frames = track(recording, front_end);
  EXPECT_TRUE(frames[4].observations.empty());
  EXPECT_GT(pixels(frames[5], 0).size(), 230u);
}

TEST(FrontEnd, NamesCameraAndSizesOfAForeignImage) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  const cv::Mat good = daylight().images[0][0], half(240, 376, CV_8U), colour(480, 752, CV_8UC3);
  const auto process = [&](const std::vector<cv::Mat>& images) {
    return [&front_end, images] { front_end.process(Time(), images, Quat::Identity()); };
  };
  using testing::AllOf;
  using testing::HasSubstr;
  using testing::ThrowsMessage;
  EXPECT_THAT(
      process({good, half}),
      ThrowsMessage<InputError>(AllOf(HasSubstr("'cam1'"), HasSubstr("376 x 240"), HasSubstr("752 x 480"))));
  EXPECT_THAT(process({colour, good}), ThrowsMessage<InputError>(HasSubstr("'cam0'")));
  EXPECT_THAT(process({good}), ThrowsMessage<InputError>(HasSubstr("1 images for 2 cameras")));
  EXPECT_THROW(FrontEnd(Rig(), {}), InputError);
}

TEST(DrawTracks, PaintsAllCamerasSideBySide) {
  FrontEnd front_end(daylight().sequence.rig(), {});
  front_end.process(Time(), daylight().images[0], Quat::Identity());
  const cv::Mat picture = drawTracks(front_end, daylight().images[0]);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_EQ(picture.cols, 2 * 752);
  EXPECT_GT(picture.rows, 480);
  const Eigen::Vector2f position = front_end.tracks().front().warp.position;
  const auto dot = picture.at<cv::Vec3b>(static_cast<int>(position.y()), static_cast<int>(position.x()));
  EXPECT_GT(std::max({dot[0], dot[1], dot[2]}) - std::min({dot[0], dot[1], dot[2]}), 100);
  EXPECT_EQ(drawTracks(front_end, {cv::Mat(), cv::Mat()}).size(), picture.size());
}

/// Median error, px, of the rays of camera 1 at each frame's time, and their number. Its images are those of
/// `later` frames later; `motion_is_known`: to the front end.
std::pair<double, size_t> rightRayError(int later, bool motion_is_known) {
  const TestSequence& sequence = daylight().sequence;
  FrontEnd front_end(sequence.rig(), {});
  const std::shared_ptr<const Camera> right = front_end.cameras()[1];
  std::vector<double> errors_px;
  for (int i = 0; i + later < kFrames; ++i) {
    const Rigid3 body_from_world = sequence.worldFromBody(i).inverse();
    RigMotion motion;
    if (motion_is_known) {
      motion.frame_from_image_B = {Rigid3(), body_from_world * sequence.worldFromBody(i + later)};
    }
    const FrameTracks tracks = front_end.process(
        TestSequence::time(i),
        {daylight().images[static_cast<size_t>(i)][0], daylight().images[static_cast<size_t>(i + later)][1]},
        daylight().previousFromCurrent(i), motion);
    const std::map<TrackId, Vec2> left = pixels(tracks, 0);
    for (const FeatureObservation& observation : tracks.observations) {
      if (observation.camera != 1) continue;
      const auto true_pixel = sequence.truePixel(i, 0, left.at(observation.track), i, 1);
      if (!true_pixel) continue;
      const auto true_ray = right->unproject(*true_pixel);
      errors_px.push_back(right->calibration().fx_px * (*true_ray - observation.bearing_C).norm());
    }
  }
  if (errors_px.empty()) return {0.0, 0};
  std::nth_element(errors_px.begin(), errors_px.begin() + static_cast<int>(errors_px.size() / 2),
                   errors_px.end());
  return {errors_px[errors_px.size() / 2], errors_px.size()};
}

TEST(FrontEnd, GivesWhatAnotherCameraSawLaterAsItWouldHaveSeenItAtTheFramesTime) {
  const auto [together_px, together] = rightRayError(0, false);
  const auto [later_px, later] = rightRayError(1, true);
  const auto [unknown_px, unknown] = rightRayError(1, false);
  EXPECT_LT(together_px, 0.2);
  EXPECT_LT(later_px, 0.3);
  EXPECT_GT(later, 0.8 * static_cast<double>(together) * (kFrames - 1) / kFrames);
  EXPECT_GT(unknown_px, 2.0) << "the sequence moves too little to test anything";
}

// A gyroscope in wrong units reports radians where the rotation is hundredths of a radian.
TEST(FrontEnd, FollowsPointsByTheOtherOpinionWhereImagesContradictTheFirst) {
  const Recording& recording = daylight();
  const Quat wrong = so3::exp(0.5 * Vec3(0.6, -0.6, 0.5).normalized());
  FrontEnd right(recording.sequence.rig(), {}), deceived(recording.sequence.rig(), {}),
      rescued(recording.sequence.rig(), {});
  int kept_right = 0, kept_deceived = 0, kept_rescued = 0;
  for (int i = 0; i < 6; ++i) {
    const Time time = TestSequence::time(i);
    const std::vector<cv::Mat>& images = recording.images[static_cast<size_t>(i)];
    const Quat truth = recording.previousFromCurrent(i);
    right.process(time, images, truth);
    deceived.process(time, images, truth * wrong);
    rescued.process(time, images, truth * wrong, truth);
    kept_right += right.statistics().kept;
    kept_deceived += deceived.statistics().kept;
    kept_rescued += rescued.statistics().kept;
  }
  EXPECT_LT(kept_deceived, kept_right / 2);
  EXPECT_GT(kept_rescued, 0.9 * kept_right);
}

}  // namespace
}  // namespace lodeline

#include "lodeline/estimator/sonar/landmark_response.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/sonar/sonar_range_factor.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {
namespace {

/// A filled window, and a range along the axis of the newest camera to eight of its landmarks.
class LandmarkElimination : public testing::Test {
 protected:
  LandmarkElimination() {
    prior_ = test_.fill();
    for (const auto& [id, track] : test_.window.tracks()) {
      if (track.landmark && track.landmark->inverseDistance() > 0.05 && tracks_.size() < 8)
        tracks_.push_back(id);
    }
  }

  Factor rangeFactor(double sigma_m) {
    std::vector<SurfaceLandmark> members;
    Factor factor;
    factor.blocks = {test_.window.newest().pose.data()};
    std::vector<double*> landmarks;
    for (const TrackId id : tracks_) {
      Landmark& landmark = *test_.window.tracks().at(id).landmark;
      factor.blocks.push_back(test_.window.find(landmark.host)->pose.data());
      members.push_back({landmark.base, members.size(), 1.0});
      landmarks.push_back(landmark.parameters.data());
    }
    factor.blocks.insert(factor.blocks.end(), landmarks.begin(), landmarks.end());
    const Rigid3& camera = test_.rig.cameras[0].body_from_camera;
    SonarBeam beam{camera.translation, Mat3::Identity()};
    const Mat3 rotation = camera.rotation.toRotationMatrix();
    beam.axes_B << rotation.col(2), rotation.col(0), rotation.col(1);
    factor.function =
        std::make_unique<SonarRangeFactor>(3.0, sigma_m, beam, camera, false, members.size(), members);
    return factor;
  }

  std::vector<LandmarkResponse> responses() {
    std::vector<LandmarkResponse> responses;
    for (const TrackId id : tracks_)
      responses.push_back(responseOf(test_.factors.landmark(test_.window, test_.window.tracks().at(id))));
    return responses;
  }

  Factor eliminated(double sigma_m, double share = 1.0) {
    auto function = std::make_unique<EliminatedLandmarksFactor>(rangeFactor(sigma_m), responses(), share);
    Factor factor;
    factor.blocks = function->blocks();
    factor.function = std::move(function);
    return factor;
  }

  TestWindow test_{1};
  Prior prior_;
  std::vector<TrackId> tracks_;
};

/// Gives all poses of a window their rows in the same order.
void addAnchors(const Window& window, NormalEquations* system) {
  for (const auto& frame : window.frames()) {
    Prior prior;
    prior.append(frame->pose.data(), kPoseSize, Eigen::VectorXd::Ones(kPoseTangentSize));
    Factor anchor;
    anchor.function = std::make_unique<PriorFactor>(prior);
    anchor.blocks = {frame->pose.data()};
    system->add(anchor);
  }
}

TEST_F(LandmarkElimination, HasTheHessianOfTheSchurComplement) {
  ASSERT_EQ(tracks_.size(), 8u);
  // The second range is far better than a real one, so that the landmarks' own errors matter.
  for (const double sigma_m : {0.05, 0.001}) {
    NormalEquations all, reduced, visual;
    for (NormalEquations* system : {&all, &reduced, &visual}) addAnchors(test_.window, system);
    for (const TrackId id : tracks_) {
      const LandmarkFactors terms = test_.factors.landmark(test_.window, test_.window.tracks().at(id));
      for (const Factor& factor : terms.factors) all.add(factor);
      reduced.addEliminated(terms);
      visual.addEliminated(terms);
    }
    all.add(rangeFactor(sigma_m));
    reduced.add(eliminated(sigma_m));
    const int kept = visual.size();
    ASSERT_EQ(reduced.size(), kept);
    ASSERT_EQ(all.size(), kept + 3 * 8);
    // What the range adds, with the landmarks as variables and with them eliminated.
    const Eigen::MatrixXd expected =
        denseSchur(all.hessian(), all.gradient(), kept).hessian - visual.hessian();
    const Eigen::MatrixXd added = reduced.hessian() - visual.hessian();
    EXPECT_GT(expected.norm(), 1.0);
    EXPECT_LT((expected - added).norm(), 1e-5 * expected.norm()) << sigma_m;
  }
}

TEST_F(LandmarkElimination, VarianceGrowsByTheErrorsOfTheLandmarks) {
  const auto varianceOf = [&](double sigma_m, double share) {
    return EliminatedLandmarksFactor(rangeFactor(sigma_m), responses(), share).variance();
  };
  EXPECT_GT(varianceOf(0.001, 1.0), 2.0);
  EXPECT_NEAR(varianceOf(0.05, 1.0) - 1.0, (varianceOf(0.001, 1.0) - 1.0) / 2500.0, 1e-9);
  EXPECT_NEAR(varianceOf(0.05, 7.0) - 1.0, 7.0 * (varianceOf(0.05, 1.0) - 1.0), 1e-9);
}

TEST_F(LandmarkElimination, LandmarksFollowTheirPoses) {
  // A response is the derivative of the landmark's best position: a common motion of the host and all other
  // poses leaves the landmark, which is relative to its host, where it is.
  const LandmarkResponse response = responses().front();
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  double size = 0.0;
  for (const LandmarkResponse::Gain& gain : response.gains) {
    ASSERT_EQ(gain.ambient_size, kPoseSize);
    Eigen::Matrix<double, 6, 1> motion;
    motion << Vec3(0.1, -0.3, 0.2) + Vec3::UnitZ().cross(Vec3(gain.block)), Vec3::UnitZ();
    moved += gain.by_block * motion;
    size += (gain.by_block * motion).norm();
  }
  EXPECT_GT(size, 1e-3);
  EXPECT_LT(moved.norm(), 1e-9 * size);
}

}  // namespace
}  // namespace lodeline

#include <gtest/gtest.h>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/test_data.h"

// Tests on published trajectories with the results of their authors' tools.

namespace lodeline {
namespace {

class ReferenceResults : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = testData("trajectories");
    if (!folder) GTEST_SKIP() << missingTestData("trajectories");
    folder_ = *folder;
  }

  Trajectory read(const std::string& name) { return readTrajectory(folder_ / name, {}, diagnostics_); }

  Evaluation compare(const std::string& estimate, const std::string& reference, AlignmentType alignment) {
    EvaluationOptions options;
    options.alignment = alignment;
    return evaluate(read(estimate), read(reference), options, diagnostics_);
  }

  std::filesystem::path folder_;
  Diagnostics diagnostics_;
};

/// stats.json of one result file.
struct Figures {
  double rmse, mean, median, std, min, max;
};

void expectNear(const Statistics& found, const Figures& expected, double tolerance) {
  EXPECT_NEAR(found.rmse, expected.rmse, tolerance);
  EXPECT_NEAR(found.mean, expected.mean, tolerance);
  EXPECT_NEAR(found.median, expected.median, tolerance);
  EXPECT_NEAR(found.std, expected.std, tolerance);
  EXPECT_NEAR(found.min, expected.min, tolerance);
  EXPECT_NEAR(found.max, expected.max, tolerance);
}

// evo/res_files/orb_ape.zip and orb_rpe.zip, stats.json. The number of stretches is sse / rmse^2.
TEST_F(ReferenceResults, EvoOrbSlamOnKitti00) {
  const Evaluation e = compare("evo/KITTI_00_ORB.txt.gz", "evo/KITTI_00_gt.txt.gz", AlignmentType::SE3);
  expectNear(e.absolute.position(),
             {1.3034497145650266, 1.1569971285389768, 1.065624769555848, 0.6002822693968323,
              0.06931322021483087, 3.587949120678954},
             1e-6);
  EXPECT_EQ(e.consecutive.size(), 353u);
  expectNear(computeStatistics(e.consecutive.translation_m),
             {0.22626134329310163, 0.16901737200653275, 0.13848432516645606, 0.1504238127053164,
              0.025322719660754993, 1.2722090778658726},
             1e-5);
}

// evo/res_files/sptam_ape.zip and sptam_rpe.zip, stats.json.
TEST_F(ReferenceResults, EvoSptamOnKitti00) {
  const Evaluation e = compare("evo/KITTI_00_SPTAM.txt.gz", "evo/KITTI_00_gt.txt.gz", AlignmentType::SE3);
  expectNear(e.absolute.position(),
             {3.738487907582613, 3.4909766330848684, 3.6425846417432637, 1.3376748418045645,
              0.694787347406252, 7.7689774065713175},
             1e-6);
  EXPECT_EQ(e.consecutive.size(), 355u);
  expectNear(computeStatistics(e.consecutive.translation_m),
             {0.27607109043606004, 0.22284797909537604, 0.1783338691210611, 0.16295405851853487,
              0.01875232105572263, 1.2065944255781629},
             1e-5);
}

// These have no published results. The bounds are slightly above the measured values (0.24 % of the path,
// 1.95 deg, mostly a constant rotation of the body frame); wrong times, conventions or alignment exceed them
// by far.
TEST_F(ReferenceResults, RpgVisualInertialEstimatesAlignInYaw) {
  for (const char* name : {"laptop_vislam_ba_MH_04", "laptop_vislam_ba_V1_02"}) {
    for (const char* estimate : {"/stamped_ba_estimate0.txt.gz", "/stamped_ba_estimate1.txt.gz"}) {
      const std::string sequence = std::string("rpg/") + name;
      const Evaluation e =
          compare(sequence + estimate, sequence + "/stamped_groundtruth.txt.gz", AlignmentType::Yaw);
      EXPECT_EQ(e.pairs.size(), e.estimate.size());
      EXPECT_LT(e.absolute.position().rmse, 0.003 * e.reference_path_m);
      EXPECT_LT(e.absolute.rotation().rmse, 2.0);
    }
  }
}

TEST_F(ReferenceResults, RpgSimilarityIsAtLeastAsCloseAsYawAlone) {
  const std::string folder = "rpg/laptop_vislam_ba_MH_04/";
  const auto rmse = [&](AlignmentType type) {
    return compare(folder + "stamped_ba_estimate0.txt.gz", folder + "stamped_groundtruth.txt.gz", type)
        .absolute.position()
        .rmse;
  };
  EXPECT_LE(rmse(AlignmentType::SE3), rmse(AlignmentType::Yaw));
  EXPECT_LE(rmse(AlignmentType::Sim3), rmse(AlignmentType::SE3));
  EXPECT_LT(rmse(AlignmentType::Yaw), rmse(AlignmentType::None));
}

TEST_F(ReferenceResults, EvoEurocTruthAgainstAMonocularEstimate) {
  const Evaluation e = compare("evo/V102.txt.gz", "evo/V102_groundtruth.csv.gz", AlignmentType::Sim3);
  EXPECT_GT(e.pairs.size(), 780u);
  EXPECT_LT(e.absolute.position().rmse, 0.1);
  EXPECT_EQ(diagnostics_.count("trajectory_duplicate"), 4);
}

TEST_F(ReferenceResults, UnderwaterColmapTrajectoriesSurviveASimilarity) {
  const Rigid3 transform(Quat(Eigen::AngleAxisd(0.8, Vec3(1.0, 2.0, 3.0).normalized())),
                         Vec3(10.0, 20.0, 30.0));
  for (const char* name : {"cave", "bus_outside", "cemetery"}) {
    const Trajectory truth = read(std::string("afrl_svin_colmap/") + name + ".txt.gz");
    EvaluationOptions options;
    options.alignment = AlignmentType::Sim3;
    const Evaluation e = evaluate(test::transformed(truth, transform, 0.2), truth, options, diagnostics_);
    EXPECT_EQ(e.pairs.size(), truth.size());
    EXPECT_NEAR(e.alignment.scale, 5.0, 1e-9);
    EXPECT_LT(e.absolute.position().max, 1e-6);
    EXPECT_LT(e.absolute.rotation().max, 1e-6);
  }
}

}  // namespace
}  // namespace lodeline

#pragma once

#include <random>
#include <vector>

#include "lodeline/mapping/graph/pose_graph.h"

namespace lodeline {

/// Draw from a normal distribution with mean zero.
Eigen::VectorXd drawn(const Eigen::MatrixXd& covariance, std::mt19937_64* generator);

/// A measured relative pose: the true one with an error drawn from its covariance.
RelativePose withError(const RelativePose& truth, std::mt19937_64* generator);

/// A dive along a circuit of 150 m with rising and falling floor, swum twice: keyframes 1 m apart.
struct CircuitDive {
  int dive = 0;
  KeyframeId first_id = 0;
  std::vector<Rigid3> truth;           ///< world_from_body
  std::vector<MapKeyframe> keyframes;  ///< odometry with drift and its covariance
};

struct GraphCircuitOptions {
  int keyframes = 300;  ///< 150 for one round
  int dive = 0;
  KeyframeId first_id = 0;
  int first_place = 0;  ///< on the circuit, m
  double position_m_per_sqrt_m = 0.01;
  double rotation_rad_per_sqrt_m = 0.003;  ///< about the vertical; roll and pitch err by 0.1 degrees
};
CircuitDive swumCircuit(const GraphCircuitOptions& options, std::mt19937_64* generator);

/// The keyframes of a dive, which begins at its true pose. Without loops.
PoseGraph graphOf(const CircuitDive& dive);

/// Covariance of loops: 2 cm, 0.3 degrees.
Mat6 loopCovariance();
/// A true loop between keyframes, with an error drawn from loopCovariance().
Loop trueLoop(KeyframeId old_id, const Rigid3& old_pose, KeyframeId new_id, const Rigid3& new_pose,
              std::mt19937_64* generator);
/// A false loop: a relative pose like that of true loops, within 1 m and 20 degrees, between any keyframes.
Loop falseLoop(KeyframeId old_id, KeyframeId new_id, std::mt19937_64* generator);

/// RMS of positions after the best motion of 4 degrees of freedom onto the truth, m.
double alignedRmse_m(const std::vector<Rigid3>& estimate, const std::vector<Rigid3>& truth);

}  // namespace lodeline

#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lodeline/estimator/visual/camera_views.h"
#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {

/// Chain rule from the nodes of ReprojectionSystem to the window's blocks. A node's step is T times the step
/// of the blocks. The camera pose of a frame depends on the calibration and the pose of its body, or of two
/// bodies where it is interpolated. The other nodes are blocks themselves.
class CameraToBodyChainRule {
 public:
  /// All must outlive this object. `rows`: number of coordinates of all nodes; frames come first, six each.
  CameraToBodyChainRule(const Window& window, const CameraStates& states, const CameraViews& first, int rows);

  /// Computes T at the present camera poses.
  void update();

  /// Computes T^T h T and T^T g; only the lower triangle of h is read.
  void transform(const Eigen::MatrixXd& h_nodes, const Eigen::VectorXd& g_nodes, Eigen::MatrixXd* h,
                 Eigen::VectorXd* g) const;

  /// T times a step of `system`.
  Eigen::VectorXd stepOfNodes(const NormalEquations& system, const Eigen::VectorXd& step) const;

  /// Offsets as in transform().
  const std::vector<NormalEquations::Block>& blocks() const { return blocks_; }

 private:
  struct Part {
    int column = 0;  ///< of the pose
    Mat6 by_pose;
  };
  struct Follows {
    std::array<Part, 2> parts;
    int count = 1;
    auto begin() const { return parts.begin(); }
    auto end() const { return parts.begin() + count; }
  };
  void append(double* value, int size);
  int columnOf(const Frame& frame) const;
  Follows posesOf(int frame) const;
  /// The first frame that follows the pose at `column` or a later one.
  int firstTouching(int column) const;
  void addPoses(const Eigen::MatrixXd& of_nodes, Eigen::MatrixXd* h) const;
  void addCalibration(const Eigen::MatrixXd& of_nodes, const Eigen::VectorXd& g_nodes, Eigen::MatrixXd* h,
                      Eigen::VectorXd* g) const;

  const Window& window_;
  const CameraStates& states_;
  const CameraViews& first_;
  int frames_, rows_;
  int poses_ = 0;        ///< columns of the bodies' poses, which come first...
  int others_ = 0;       ///< ...then those of nodes that are blocks themselves...
  int calibration_ = 0;  ///< ...and last those of the calibration that moves all frames' nodes
  std::vector<NormalEquations::Block> blocks_;
  std::vector<Follows> follows_;  ///< by frame
};

}  // namespace lodeline

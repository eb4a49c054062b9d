// The part of ReprojectionSystem that eliminates landmarks from the nodes' equations and finds their steps.

#include "lodeline/estimator/visual/reprojection_system.h"
#include "lodeline/problem/simd_gemm.h"

namespace lodeline {

void ReprojectionSystem::subtractEliminated(const Stretch& stretch) {
  const int calibration = rows_ - 6 * frames_;
  const int first = 6 * stretch.first_frame, rows = 6 * stretch.end_frame - first;
  const auto by_frames = couplingsOfFrames(stretch);
  const auto by_calibration = couplingsOfCalibration(stretch);
  const auto rooted = rooted_gradients_.segment(stretch.column, stretch.columns);
  gradient_.segment(first, rows).noalias() -= by_frames * rooted;
  gradient_.tail(calibration).noalias() -= by_calibration * rooted;
  subtractSquare(by_frames, hessian_.block(first, first, rows, rows));
  subtractProduct(by_calibration, by_frames, hessian_.block(6 * frames_, first, calibration, rows));
  subtractSquare(by_calibration, hessian_.bottomRightCorner(calibration, calibration));
}

void ReprojectionSystem::stepLandmarks(const NormalEquations& system, const Eigen::VectorXd& step) {
  const Eigen::VectorXd of_nodes = blocks_.stepOfNodes(system, step);
  Eigen::VectorXd rooted = rooted_gradients_;
  for (const Stretch& stretch : stretches_) {
    const auto by_frames = couplingsOfFrames(stretch);
    const auto by_calibration = couplingsOfCalibration(stretch);
    auto of_stretch = rooted.segment(stretch.column, stretch.columns);
    of_stretch.noalias() +=
        by_frames.transpose() * of_nodes.segment(6 * stretch.first_frame, by_frames.rows());
    of_stretch.noalias() += by_calibration.transpose() * of_nodes.tail(by_calibration.rows());
  }
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    Eigen::Map<Vec3>(landmarks_[i].value) -=
        landmarks_[i].inverse_root * rooted.segment<kLandmarkSize>(landmarks_[i].column);
  }
}

}  // namespace lodeline

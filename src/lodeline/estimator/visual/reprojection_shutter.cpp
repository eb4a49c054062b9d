// The part of ReprojectionSystem for rolling shutters.
#include "lodeline/estimator/visual/reprojection_system.h"
#include "lodeline/factors/rolling_shutter.h"

namespace lodeline {

void ReprojectionSystem::prepareShutter(const Window& window, const FactorBuilder& factors) {
  for (const auto& frame : window.frames()) {
    for (int camera = 0; camera < cameras_; ++camera) motions_.push_back(factors.motionOf(*frame, camera));
  }
  moved_.resize(observations_.size());
  for (size_t i = 0; i < observations_.size(); ++i) observations_[i].measurement = &moved_[i];
}

void ReprojectionSystem::moveMeasurements() {
  for (size_t i = 0; i < observations_.size(); ++i) {
    const Observation& observation = observations_[i];
    moved_[i] =
        atTimeOfImage(*observation.as_measured, motionOf(observation), lineDelay_s(observation.camera));
  }
}

void ReprojectionSystem::addShutter() {
  for (int camera = 0; camera < cameras_; ++camera) {
    const int row = shutterRow() + camera;
    const Vec2& products = shutter_products_[static_cast<size_t>(camera)];
    hessian_(row, row) += products.x();
    gradient_[row] += products.y();
    const Eigen::Matrix<double, ObservationColumns::kResidual, 1> by_lens =
        by_calibration_[static_cast<size_t>(camera)].col(ObservationColumns::kLineDelay);
    if (camera > 0)
      hessian_.block<1, kExtrinsicsSize>(row, secondaryRow(camera)) +=
          by_lens.segment<kExtrinsicsSize>(ObservationColumns::kSecondary).transpose();
    if (!states_.intrinsics.empty())
      hessian_.block<1, kIntrinsicsSize>(row, intrinsicsRow(camera)) +=
          by_lens.segment<kIntrinsicsSize>(ObservationColumns::kIntrinsics).transpose();
  }
}

}  // namespace lodeline

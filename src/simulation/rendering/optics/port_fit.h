#pragma once

#include "simulation/rendering/optics/port_window.h"

namespace lodeline {

/// Calibration in water of a camera behind a port.
struct PortFit {
  CameraCalibration calibration;  ///< radial-tangential, four coefficients; camera pose moved along the axis
  double rms_px = 0.0;            ///< residual that the model cannot represent
};

/// Least-squares fit (Gauss-Newton) of a radial-tangential camera to points seen through the port at `near_m`
/// to `far_m`. The parameters are focal lengths, principal point, k1 k2 p1 p2 and a shift of the centre along
/// the optical axis. A calibration with a target at these distances has the same ones.
PortFit fitRadialTangential(const CameraCalibration& in_air, const PortWindow& port, double near_m = 0.6,
                            double far_m = 4.0);

}  // namespace lodeline

#pragma once

#include <memory>
#include <string>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// The camera of a calibration with a port, exact for every distance of a point. `in_air` is the camera of
/// the same calibration without its port. The folder `ports` defines both functions.
std::shared_ptr<const Camera> makeRefractiveCamera(const CameraCalibration& calibration,
                                                   std::shared_ptr<const Camera> in_air);

/// A port after a change as in PortCorrection: normal exp([x, y, 0]) n and distance d + z of a plate, centre
/// c + change of a dome.
Port correctedPort(Port port, const Vec3& change);

/// States what is wrong with the parameters of a port. Empty where nothing is.
std::string portFault(const Port& port);

}  // namespace lodeline

#pragma once

#include <memory>
#include <optional>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Derivative of a direction by the parameters of a port. The columns are
///
///     flat:  tilt of the normal about x and about y of C (rad), distance (m), thickness (m),
///     dome:  centre x, y, z (m), inner radius (m), thickness (m),
///
/// and then the indices of air, glass and water.
using DirectionByPort = Eigen::Matrix<double, 3, Eigen::Dynamic>;

/// Refraction at the two faces of a port. The light of a point follows a path in one plane, which contains
/// the lens and an axis of symmetry of the port: the normal of a plate, or the line to the centre of a dome.
/// Sources: A. Agrawal, S. Ramalingam, Y. Taguchi, V. Chari, "A theory of multi-layer flat refractive
/// geometry", CVPR 2012; M. She, D. Nakath, Y. Song, K. Koeser, "Refractive geometry for underwater domes",
/// ISPRS Journal of Photogrammetry and Remote Sensing 183, 2022.
class PortRefraction {
 public:
  virtual ~PortRefraction() = default;

  /// Direction (any length) in which light of a point in the water arrives at the lens, with its derivatives.
  /// Exact to 1e-12 rad. Returns nothing for a point nearer than the outer face and where no light arrives.
  virtual std::optional<Vec3> towards(const Vec3& point_C, Mat3* by_point = nullptr,
                                      DirectionByPort* by_port = nullptr) const = 0;

  /// Line in the water of a direction from the lens; nothing where it does not reach the water.
  virtual std::optional<ViewRay> through(const Vec3& direction_C) const = 0;
};

std::unique_ptr<const PortRefraction> makePortRefraction(const Port& port);
std::unique_ptr<const PortRefraction> makeFlatPort(const Port& port);
std::unique_ptr<const PortRefraction> makeDomePort(const Port& port);

/// Direction behind a surface by Snell's law, unit. `direction` and `normal` are unit vectors with a positive
/// product. `index_ratio` is the index before the surface over that behind. Nothing at total reflection.
std::optional<Vec3> refractedDirection(const Vec3& direction, const Vec3& normal, double index_ratio);

}  // namespace lodeline

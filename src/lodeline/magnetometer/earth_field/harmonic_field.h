#pragma once

#include "lodeline/magnetometer/earth_field/magnetic_models.h"
#include "lodeline/types.h"

namespace lodeline {

/// Computes the field -grad V, in Earth-fixed axes and the unit of the coefficients, of the potential
///
///     V = a sum_n (a/r)^(n+1) sum_m (g_nm cos(m lambda) + h_nm sin(m lambda)) P_nm(sin(phi))
///
/// P_nm are Schmidt semi-normalized Legendre functions, and a = 6371.2 km is the reference radius. r,
/// phi and lambda are those of `geocentric_m` (x to the meridian of Greenwich, z to the north pole). `g`
/// and `h` choose the coefficients or their secular variation. Regular at the poles: the solid harmonics
/// and their derivatives are computed in Cartesian coordinates (L. E. Cunningham, "On the computation of
/// the spherical harmonic terms needed during the numerical integration of the orbital motion of an
/// artificial satellite", Celestial Mechanics 2, 1970; equations 3.29 to 3.33 of O. Montenbruck and E.
/// Gill, "Satellite Orbits", 2000).
Vec3 harmonicField(const CoefficientTable& table, double GaussCoefficient::*g, double GaussCoefficient::*h,
                   const Vec3& geocentric_m);

/// A position on the WGS84 ellipsoid in Earth-fixed axes, m.
Vec3 geocentricPosition(const GeodeticPosition& position);

/// Rotation from east, north, up at a position to Earth-fixed axes.
Mat3 geocentricFromEnu(const GeodeticPosition& position);

}  // namespace lodeline

#pragma once

#include <string>
#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// The 48 ways to exchange and turn round three axes: matrices with one 1 or -1 a row and a column. The
/// identity comes first; 24 are rotations, 24 mirror.
const std::vector<Mat3>& signedAxes();

/// The one nearest to an orthonormal matrix.
Mat3 nearestSignedAxes(const Mat3& matrix);

/// In words what the true x, y and z are in the given readings: "x is y, y is -x, z is z".
std::string describeSignedAxes(const Mat3& true_from_given);

}  // namespace lodeline

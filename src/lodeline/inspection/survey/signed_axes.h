#pragma once

#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// The 48 signed permutations of three axes: matrices with one 1 or -1 per row and column. The identity comes
/// first; 24 are rotations, 24 are reflections.
const std::vector<Mat3>& signedAxes();

/// The nearest one to an orthonormal matrix.
Mat3 nearestSignedAxes(const Mat3& matrix);

/// Description of the true x, y and z in terms of the given readings: "x is y, y is -x, z is z".
std::string describeSignedAxes(const Mat3& true_from_given);

}  // namespace lodeline

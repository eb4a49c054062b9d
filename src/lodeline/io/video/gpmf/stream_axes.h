#pragma once

#include <optional>
#include <string>

#include "lodeline/io/video/gpmf/gpmf_payload.h"

namespace lodeline::gpmf {

/// Rotation from the order in which a three-axis stream stores its numbers to the body frame B. B has the
/// axes that GoPro calls X, Y and Z, in this order; it is right-handed, and Z points up in a camera that
/// stands.
struct StreamAxes {
  Mat3 body_from_stored = Mat3::Identity();
  std::string source;     ///< what stated the axes, for messages
  bool is_known = false;  ///< false: neither the stream nor the model of the camera states them
  std::string problem;    ///< a statement that contradicts another one and is not used
};

/// body_from_stored from letters such as "YxZ": the first number is along +Y, the second along -X, the third
/// along +Z. Returns nothing for other texts, and for axes that are not right-handed.
std::optional<Mat3> fromLetters(const std::string& letters);

/// Finds the axes of a stream: ORIN; else MTRX with ORIO; else the stream's name, as "Gyroscope (z,x,y)";
/// else the order that GoPro documents for the model; else Z, X, Y, to which GoPro's output is defined.
StreamAxes axesOf(const Stream& stream);

}  // namespace lodeline::gpmf

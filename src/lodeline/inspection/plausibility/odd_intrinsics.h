#pragma once

#include <string>

#include "lodeline/rig.h"

namespace lodeline {

/// Implausible intrinsics of a camera.
struct OddIntrinsics {
  std::string words;  ///< empty where the intrinsics are plausible
  /// Whether the cause is known: four numbers in another order, or those of another image size.
  bool is_explained = false;
};
OddIntrinsics oddIntrinsics(const CameraCalibration& camera);

}  // namespace lodeline

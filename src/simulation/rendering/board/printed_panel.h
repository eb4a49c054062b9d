#pragma once

#include <functional>

#include "lodeline/types.h"
#include "simulation/rendering/cave/triangle_mesh.h"
#include "simulation/rendering/optics/camera_optics.h"

namespace lodeline {

/// A flat panel with a print of black on white. The print is a function of the place, so pixels can average
/// it at any resolution.
struct PrintedPanel {
  Rigid3 world_from_print;                      ///< print: x to the right, y up, z out of the panel
  std::function<bool(double, double)> isBlack;  ///< of x and y, m

  /// Number of triangles of each panel. Those of all panels of a world are the first ones of its mesh.
  static constexpr uint32_t kTriangles = 2;
};

/// Adds a rectangle parallel to the print as two triangles, lit on the side of its z axis.
void addRectangle(const Vec3& centre_T, double half_width_m, double half_height_m, const Material& material,
                  const Rigid3& world_from_print, TriangleMesh* mesh);

/// Averages a print over the area of each pixel of one image.
class PanelSampler {
 public:
  PanelSampler(const PrintedPanel& panel, const CameraOptics& optics, const Rigid3& world_from_camera);

  /// Share of the light that the print reflects at a pixel which sees the panel, relative to white paper.
  float brightness(int x, int y) const;

 private:
  const PrintedPanel& panel_;
  const CameraOptics& optics_;
  Mat3 print_from_camera_;
  Vec3 camera_T_;  ///< position of the camera relative to the print, m
};

}  // namespace lodeline

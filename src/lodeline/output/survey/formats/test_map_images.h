#pragma once

#include <string>

#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/map/test_dive.h"

namespace lodeline::test {

/// A map with a place on the Earth.
inline DiveMap windingMap() {
  DiveMapOptions options;
  options.entrance = kDevilsEye;
  Diagnostics diagnostics;
  return makeDiveMap(windingDive(30.0), options, {}, &diagnostics);
}

/// Images of two cameras with the models radial-tangential and equidistant at every tenth pose.
inline MapImages twoCameras(const DiveMap& map) {
  MapImages images;
  CameraCalibration camera;
  camera.width_px = 800;
  camera.height_px = 600;
  camera.fx_px = camera.fy_px = 400.0;
  camera.cx_px = 399.5;
  camera.cy_px = 299.5;
  camera.model = "radial-tangential";
  camera.distortion = {-0.1, 0.01, 0.001, 0.002};
  camera.body_from_camera = Rigid3(Quat(0.5, -0.5, 0.5, -0.5), Vec3(0.1, 0.02, 0.03));
  images.cameras = {camera, camera};
  images.cameras[1].model = "equidistant";
  for (size_t i = 0; i < map.trajectory.size(); i += 10) {
    images.images.push_back(
        {0, i, "cam0/data/" + std::to_string(map.trajectory.poses[i].time.nanoseconds()) + ".png"});
    images.images.push_back(
        {1, i, "cam1/data/" + std::to_string(map.trajectory.poses[i].time.nanoseconds()) + ".png"});
  }
  return images;
}

}  // namespace lodeline::test

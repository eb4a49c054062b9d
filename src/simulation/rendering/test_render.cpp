#include "simulation/rendering/test_render.h"

#include <cmath>
#include <string>

namespace lodeline {

Centerline RenderFixture::shortPassage(double length_m, uint64_t seed) {
  CenterlineOptions passage;
  passage.seed = seed;
  passage.length_m = length_m;
  passage.lead_in_m = 6.0;
  passage.run_out_m = 8.0;
  return Centerline::generate(passage);
}

std::shared_ptr<const RenderWorld> RenderFixture::shortCave() {
  static const auto world = [] {
    CaveOptions cave;
    cave.seed = 3;
    cave.max_triangles = 300'000;
    return buildCaveWorld(shortPassage(), cave);
  }();
  return world;
}

Rig RenderFixture::stereoRig(double scale) {
  Rig rig;
  for (int k = 0; k < 2; ++k) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(k);
    camera.width_px = static_cast<int>(std::lround(640 * scale));
    camera.height_px = static_cast<int>(std::lround(480 * scale));
    camera.fx_px = (421.0 + k) * scale;
    camera.fy_px = (420.5 - k) * scale;
    camera.cx_px = (320.4 - 3 * k) * scale;
    camera.cy_px = (238.7 + 2 * k) * scale;
    camera.model = "radial-tangential";
    camera.distortion = {-0.18, 0.05, 0.0005, -0.0003};
    Mat3 rotation;  // camera x right, y down, z forward in a body with x forward, y left, z up
    rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    const Quat off(Eigen::AngleAxisd(0.008 * k, Vec3(0.3, 0.9, -0.3).normalized()));
    camera.body_from_camera = Rigid3(Quat(rotation) * off, Vec3(0.1, 0.06 - 0.12 * k, 0.002 * k));
    rig.cameras.push_back(camera);
  }
  return rig;
}

WorldFromBodyAt RenderFixture::swim(const Centerline& passage) {
  return [passage](double time_s) {
    const double s = 2.0 + 0.3 * std::max(0.0, time_s);
    const PassageStation here = passage.at(s);
    const double sway_m = 0.2 * std::sin(0.8 * s);
    const Vec3 ahead = passage.at(s + 1.5).position_W - here.position_W;
    const Vec3 level = ahead.normalized();
    const Vec3 forward =
        (level + Vec3(0.0, 0.0, -0.1) + 0.3 * sway_m * Vec3::UnitZ().cross(level)).normalized();
    const Vec3 left = Vec3::UnitZ().cross(forward).normalized();
    Mat3 rotation;
    rotation << forward, left, forward.cross(left);
    return Rigid3(Quat(rotation), here.position_W + sway_m * left);
  };
}

}  // namespace lodeline

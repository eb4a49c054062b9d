// Renders a few images along a passage, for visual checks during work on the renderer:
//   render_preview DIR [florida|yucatan|wreck] [clean|field|open|ideal] [count] [seed]
#include <fmt/core.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "simulation/rendering/cave/centerline.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {
namespace {

double cpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Rig previewRig() {
  Rig rig;
  for (int k = 0; k < 2; ++k) {
    CameraCalibration camera;
    camera.name = "cam" + std::to_string(k);
    camera.width_px = 640;
    camera.height_px = 480;
    camera.fx_px = camera.fy_px = 420.0;
    camera.cx_px = 320.4;
    camera.cy_px = 238.7;
    camera.model = "radial-tangential";
    camera.distortion = {-0.18, 0.05, 0.0005, -0.0003};
    Mat3 rotation;  // camera x right, y down, z forward in a body with x forward, y left, z up
    rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    camera.body_from_camera = Rigid3(Quat(rotation), Vec3(0.1, 0.06 - 0.12 * k, 0.0));
    rig.cameras.push_back(camera);
  }
  return rig;
}

Rigid3 swimPose(const Centerline& line, double s) {
  const PassageStation station = line.at(s);
  const double sway = 0.25 * std::sin(0.8 * s);
  Vec3 forward = (line.at(s + 1.5).position_W - station.position_W).normalized();
  forward = (forward + Vec3(0.0, 0.0, -0.12) + 0.3 * sway * Vec3::UnitZ().cross(forward)).normalized();
  const Vec3 left = Vec3::UnitZ().cross(forward).normalized();
  Mat3 rotation;
  rotation << forward, left, forward.cross(left);
  return Rigid3(Quat(rotation), station.position_W + sway * left);
}

/// Pose on a circle of seven metres around the wreck, looking inwards and ahead.
Rigid3 circlePose(double s) {
  const double angle = s / 14.0;
  const Vec3 position(14.0 * std::cos(angle), 7.5 * std::sin(angle), 2.2 + 1.2 * std::sin(2.0 * angle));
  const Vec3 forward =
      (Vec3(0.0, 0.0, 1.6) + 2.0 * Vec3(-std::sin(angle), std::cos(angle), 0.0) - position).normalized();
  const Vec3 left = Vec3::UnitZ().cross(forward).normalized();
  Mat3 rotation;
  rotation << forward, left, forward.cross(left);
  return Rigid3(Quat(rotation), position);
}

int run(const std::string& folder, const std::string& place, const std::string& water, int count,
        uint64_t seed) {
  CenterlineOptions passage;
  passage.seed = seed;
  const Centerline line = Centerline::generate(passage);
  CaveOptions cave;
  cave.seed = seed;
  if (place == "yucatan") cave.style = CaveStyle::yucatanDecorated();
  const auto started = std::chrono::steady_clock::now();
  const bool wreck = place == "wreck";
  WreckOptions ship;
  ship.seed = seed;
  const auto world = wreck ? buildWreckWorld(ship) : buildCaveWorld(line, cave);
  const double build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("world: {} triangles, {:.1f} s, peak {:.0f} MB\n", world->scene.triangleCount(), build_s,
             usage.ru_maxrss / 1024.0);
  RenderSettings settings = water == "open"    ? RenderSettings::openWater()
                            : water == "field" ? RenderSettings::field()
                            : water == "ideal" ? RenderSettings::ideal()
                                               : RenderSettings::clean();
  const ImageRenderer renderer(world, previewRig(), settings);
  const double speed = 0.3;
  const WorldFromBodyAt motion = [&](double t) {
    return wreck ? circlePose(speed * t) : swimPose(line, speed * t);
  };
  for (int n = 0; n < count; ++n) {
    const double t = (2.0 + n * (passage.length_m - 4.0) / std::max(1, count)) / speed;
    const double before = cpuSeconds();
    const cv::Mat image = renderer.render(0, motion, t);
    const double core_ms = 1e3 * (cpuSeconds() - before);
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(image, corners, 2000, 0.01, 8);
    const ExposureSetting setting = renderer.exposure(0, motion, t);
    fmt::print("frame {:2d}: {:.0f} core-ms, {} corners, exposure {:.1f} ms, gain {:.1f}, mean {:.0f}\n", n,
               core_ms, corners.size(), 1e3 * setting.exposure_s, setting.gain, cv::mean(image)[0]);
    cv::imwrite(fmt::format("{}/{}_{}_{:02d}.png", folder, place, water, n), image);
  }
  return 0;
}

}  // namespace
}  // namespace lodeline

int main(int argc, char** argv) {
  const auto argument = [&](int i, const char* otherwise) {
    return std::string(argc > i ? argv[i] : otherwise);
  };
  return lodeline::run(argument(1, "."), argument(2, "florida"), argument(3, "clean"),
                       std::stoi(argument(4, "6")), std::stoull(argument(5, "1")));
}

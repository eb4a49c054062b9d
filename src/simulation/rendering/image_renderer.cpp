#include "simulation/rendering/image_renderer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "simulation/rendering/light/haze_volume.h"
#include "simulation/rendering/light/place_light.h"
#include "simulation/rendering/light/surface_shader.h"
#include "simulation/rendering/optics/motion_blur.h"
#include "simulation/rendering/optics/pixel_hash.h"

namespace lodeline {
namespace {

constexpr int kPacketWidth = 4, kPacketHeight = 4;

/// Pose of a camera in the world, single precision.
struct CameraPose {
  explicit CameraPose(const Rigid3& world_from_camera)
      : rotation(world_from_camera.rotation.toRotationMatrix().cast<float>()),
        position(world_from_camera.translation.cast<float>()) {}
  Mat3f rotation;
  Vec3f position;
};

void aim(RayPacket& rays, int lane, const CameraOptics& optics, int pixel, const CameraPose& pose) {
  rays.set(lane, pose.position + pose.rotation * optics.origin(pixel),
           pose.rotation * optics.direction(pixel), kSight_m);
}

HazeVolume hazeOver(const CameraOptics& optics, const CameraPose& pose, const LightField& light) {
  const int spacing = HazeVolume::kNodeSpacing_px;
  const int columns = (optics.width() + spacing - 1) / spacing + 1;
  const int rows = (optics.height() + spacing - 1) / spacing + 1;
  std::vector<Vec3f> directions;
  directions.reserve(static_cast<size_t>(columns) * rows);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int x = std::min(i * spacing, optics.width() - 1), y = std::min(j * spacing, optics.height() - 1);
      directions.push_back(pose.rotation * optics.direction(y * optics.width() + x));
    }
  }
  return HazeVolume(light, pose.position, directions, columns);
}

}  // namespace

ImageRenderer::ImageRenderer(std::shared_ptr<const RenderWorld> world, const Rig& true_rig,
                             const RenderSettings& settings)
    : world_(world), settings_(settings), meter_(std::move(world), settings) {
  for (const CameraCalibration& camera : true_rig.cameras) optics_.emplace_back(camera, settings.lens);
}

ImageRenderer::Light ImageRenderer::trace(int camera, const WorldFromBodyAt& motion, double middle_s,
                                          const LightField& light) const {
  const CameraOptics& optics = optics_[camera];
  const int width = optics.width(), height = optics.height();
  const auto poseAt = [&](double time_s) { return CameraPose(motion(time_s) * optics.bodyFromCamera()); };
  const CameraPose middle = poseAt(middle_s);
  const HazeVolume haze = hazeOver(optics, middle, light);
  const SurfaceShader shader(world_->scene, world_->texture);
  const double readout_s = settings_.sensor.readout_s;
  const auto boardAt = [&](const Rigid3& world_from_body) {
    return world_->board ? std::optional<BoardSampler>(std::in_place, *world_->board, optics,
                                                       world_from_body * optics.bodyFromCamera())
                         : std::nullopt;
  };

  Light out{cv::Mat(height, width, CV_32F, cv::Scalar(0)), cv::Mat(height, width, CV_32F, cv::Scalar(0))};
  const int packet_rows = (height + kPacketHeight - 1) / kPacketHeight;
  tbb::parallel_for(0, packet_rows, [&](int packet_row) {
    const int y0 = packet_row * kPacketHeight;
    // Rolling shutter: each row of packets has its own time.
    const double row_s = middle_s + readout_s * ((y0 + 0.5 * kPacketHeight) / height - 0.5);
    const CameraPose pose = readout_s > 0.0 ? poseAt(row_s) : middle;
    const std::optional<BoardSampler> board = boardAt(motion(readout_s > 0.0 ? row_s : middle_s));
    for (int x0 = 0; x0 < width; x0 += kPacketWidth) {
      RayPacket rays;
      for (int lane = 0; lane < kRayPacketSize; ++lane) {
        const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
        const bool seen = x < width && y < height && optics.sees(y * width + x);
        if (seen)
          aim(rays, lane, optics, y * width + x, pose);
        else
          rays.disable(lane);
      }
      HitPacket hits;
      world_->scene.intersect(rays, hits);
      float radiance[kRayPacketSize];
      shader.shade(rays, hits, light, optics.pixelAngle(), true, radiance);
      for (int lane = 0; lane < kRayPacketSize; ++lane) {
        if (rays.active[lane] == 0) continue;
        const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
        const HazeSample veil = haze.at(static_cast<float>(x), static_cast<float>(y), hits.range_m[lane]);
        if (board && hits.triangle[lane] < BoardPanel::kPanelTriangles && std::isfinite(hits.range_m[lane]))
          radiance[lane] *= board->brightness(x, y);
        out.radiance.at<float>(y, x) =
            optics.light(y * width + x) * (radiance[lane] * veil.transmittance + veil.radiance);
        out.range_m.at<float>(y, x) = hits.range_m[lane];
      }
    }
  });
  return out;
}

cv::Mat ImageRenderer::render(int camera, const WorldFromBodyAt& motion, double middle_s) const {
  const CameraOptics& optics = optics_[camera];
  const Rigid3 world_from_body = motion(middle_s);
  const LightField light = placeLight(settings_, optics, world_from_body, middle_s);
  ExposureSetting setting = exposure(camera, motion, middle_s);
  Light image = trace(camera, motion, middle_s, light);

  const Rigid3 middle_from_world = (world_from_body * optics.bodyFromCamera()).inverse();
  const auto fromMiddle = [&](double offset_s) {
    return (middle_from_world * motion(middle_s + offset_s) * optics.bodyFromCamera()).inverse();
  };
  ExposureMotion shutter;
  if (settings_.motion_blur) {
    shutter = {fromMiddle(-0.5 * setting.exposure_s), fromMiddle(0.5 * setting.exposure_s)};
    blurByMotion(image.radiance, image.range_m, optics, shutter);
  }
  addMarineSnow(image.radiance, image.range_m, optics, world_from_body, shutter, light, settings_.snow,
                middle_s, settings_.seed);
  if (optics.blurSigma() > 0.0) {
    cv::GaussianBlur(image.radiance, image.radiance, cv::Size(3, 3), optics.blurSigma());
  }
  const uint64_t frame = combineHash(
      settings_.seed,
      combineHash(static_cast<uint64_t>(camera), static_cast<uint64_t>(std::llround(middle_s * 1e9))));
  setting.gain *= 1.0 + settings_.sensor.gain_flicker * roughNormalFromHash(scrambleBits(frame));
  return develop(image.radiance, settings_.sensor, setting, frame);
}

std::optional<Vec3> ImageRenderer::hitPoint(int camera, const Vec2& pixel,
                                            const Rigid3& world_from_body) const {
  const auto ray = optics_[camera].ray(pixel);
  if (!ray) return std::nullopt;
  const Rigid3 world_from_camera = world_from_body * optics_[camera].bodyFromCamera();
  const Vec3 origin_W = world_from_camera * ray->origin_C;
  const Vec3 direction_W = world_from_camera.rotation * ray->direction_C;
  const auto distance = range(origin_W, direction_W);
  if (!distance) return std::nullopt;
  return Vec3(origin_W + *distance * direction_W);
}

}  // namespace lodeline

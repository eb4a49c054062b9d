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

/// The lens in water of a higher index.
IntrinsicsOptions saltier(IntrinsicsOptions lens, double index_step) {
  lens.port = withIndices(*lens.port, glassIndex(*lens.port), waterIndex(*lens.port) + index_step);
  return lens;
}

}  // namespace

ImageRenderer::ImageRenderer(std::shared_ptr<const RenderWorld> world, const Rig& true_rig,
                             const RenderSettings& settings)
    : world_(world), settings_(settings), meter_(std::move(world), settings), cameras_(true_rig.cameras) {
  for (const CameraCalibration& camera : cameras_) {
    optics_.emplace_back(camera, settings.lens);
    if (settings.lens.port && settings.halocline)
      salt_optics_.emplace_back(camera, saltier(settings.lens, settings.halocline->index_step));
    if (settings.lens.port && settings.dispersion) dispersion_.emplace_back(optics_.back());
  }
}

ImageRenderer::CameraInWater ImageRenderer::inWater(int camera, const Rigid3& world_from_body) const {
  if (salt_optics_.empty()) return {&optics_[camera], nullptr};
  const double height_W = (world_from_body * optics_[camera].bodyFromCamera()).translation.z();
  const double salt = settings_.halocline->saltShare(height_W);
  if (salt <= 0.0) return {&optics_[camera], nullptr};
  if (salt >= 1.0) return {&salt_optics_[camera], nullptr};
  const auto mixed = std::make_shared<const CameraOptics>(
      cameras_[camera], saltier(settings_.lens, salt * settings_.halocline->index_step));
  return {mixed.get(), mixed};
}

std::vector<Rigid3> ImageRenderer::rowPoses(const CameraOptics& optics, const WorldFromBodyAt& motion,
                                            double middle_s) const {
  std::vector<Rigid3> poses;
  if (settings_.sensor.readout_s <= 0.0) return poses;
  const double line_delay_s = settings_.sensor.lineDelay_s(optics.height());
  for (int y = 0; y < optics.height(); ++y)
    poses.push_back(motion(middle_s + line_delay_s * (y - 0.5 * (optics.height() - 1))));
  return poses;
}

ImageRenderer::Light ImageRenderer::trace(const CameraOptics& optics, const Rigid3& world_from_body,
                                          const std::vector<Rigid3>& row_poses,
                                          const LightField& light) const {
  const int width = optics.width(), height = optics.height();
  const CameraPose middle(world_from_body * optics.bodyFromCamera());
  const HazeVolume haze = hazeOver(optics, middle, light);
  const SurfaceShader shader(world_->scene, world_->texture, world_->texture_origin_W);
  const auto samplersAt = [&](const Rigid3& world_from_body) {
    std::vector<PanelSampler> samplers;
    for (const PrintedPanel& panel : world_->panels)
      samplers.emplace_back(panel, optics, world_from_body * optics.bodyFromCamera());
    return samplers;
  };

  Light out{cv::Mat(height, width, CV_32F, cv::Scalar(0)), cv::Mat(height, width, CV_32F, cv::Scalar(0)), {}};
  if (settings_.halocline) out.height_W = cv::Mat(height, width, CV_32F, cv::Scalar(0));
  const int packet_rows = (height + kPacketHeight - 1) / kPacketHeight;
  tbb::parallel_for(0, packet_rows, [&](int packet_row) {
    const int y0 = packet_row * kPacketHeight;
    // Rolling shutter: each row has its own pose.
    std::vector<CameraPose> poses(kPacketHeight, middle);
    for (int row = 0; row < kPacketHeight && y0 + row < static_cast<int>(row_poses.size()); ++row)
      poses[row] = CameraPose(row_poses[y0 + row] * optics.bodyFromCamera());
    const std::vector<PanelSampler> panels =
        samplersAt(static_cast<size_t>(y0) < row_poses.size() ? row_poses[y0] : world_from_body);
    for (int x0 = 0; x0 < width; x0 += kPacketWidth) {
      RayPacket rays;
      for (int lane = 0; lane < kRayPacketSize; ++lane) {
        const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
        const bool seen = x < width && y < height && optics.sees(y * width + x);
        if (seen)
          aim(rays, lane, optics, y * width + x, poses[lane / kPacketWidth]);
        else
          rays.disable(lane);
      }
      HitPacket hits;
      world_->scene.intersect(rays, hits);
      intersectBodies(light.bodies, rays, hits);
      float radiance[kRayPacketSize];
      shader.shade(rays, hits, light, optics.pixelAngle(), true, radiance);
      for (int lane = 0; lane < kRayPacketSize; ++lane) {
        if (rays.active[lane] == 0) continue;
        const int x = x0 + lane % kPacketWidth, y = y0 + lane / kPacketWidth;
        const HazeSample veil = haze.at(static_cast<float>(x), static_cast<float>(y), hits.range_m[lane]);
        const size_t panel = hits.triangle[lane] / PrintedPanel::kTriangles;
        if (panel < panels.size() && hits.body[lane] < 0 && std::isfinite(hits.range_m[lane]))
          radiance[lane] *= panels[panel].brightness(x, y);
        out.radiance.at<float>(y, x) =
            optics.light(y * width + x) * (radiance[lane] * veil.transmittance + veil.radiance);
        out.range_m.at<float>(y, x) = hits.range_m[lane];
        if (settings_.halocline) {
          out.height_W.at<float>(y, x) =
              rays.origin[2][lane] + std::min(hits.range_m[lane], kSight_m) * rays.direction[2][lane];
        }
      }
    }
  });
  return out;
}

cv::Mat ImageRenderer::render(int camera, const WorldFromBodyAt& motion, double middle_s) const {
  const Rigid3 world_from_body = motion(middle_s);
  const CameraInWater in_water = inWater(camera, world_from_body);
  const CameraOptics& optics = *in_water.optics;
  const LightField light = placeLight(settings_, optics, world_from_body, middle_s);
  ExposureSetting setting = exposure(camera, motion, middle_s);
  const std::vector<Rigid3> row_poses = rowPoses(optics, motion, middle_s);
  Light image = trace(optics, world_from_body, row_poses, light);

  const Rigid3 middle_from_world = (world_from_body * optics.bodyFromCamera()).inverse();
  const auto fromMiddle = [&](double offset_s) {
    return (middle_from_world * motion(middle_s + offset_s) * optics.bodyFromCamera()).inverse();
  };
  ExposureMotion shutter;
  if (settings_.motion_blur) {
    shutter = {fromMiddle(-0.5 * setting.exposure_s), fromMiddle(0.5 * setting.exposure_s),
               setting.exposure_s};
    blurByMotion(image.radiance, image.range_m, optics, shutter);
  }
  addMarineSnow(image.radiance, image.range_m, optics, world_from_body, shutter, light, settings_.snow,
                middle_s, settings_.seed, row_poses);
  if (settings_.halocline) {
    blurByHalocline(image.radiance, image.range_m, image.height_W,
                    middle_from_world.inverse().translation.z(), *settings_.halocline);
  }
  if (!dispersion_.empty()) dispersion_[camera].smear(image.radiance, image.range_m);
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
  const CameraInWater in_water = inWater(camera, world_from_body);
  const auto ray = in_water.optics->ray(pixel);
  if (!ray) return std::nullopt;
  const Rigid3 world_from_camera = world_from_body * optics_[camera].bodyFromCamera();
  const Vec3 origin_W = world_from_camera * ray->origin_C;
  const Vec3 direction_W = world_from_camera.rotation * ray->direction_C;
  const auto distance = range(origin_W, direction_W);
  if (!distance) return std::nullopt;
  return Vec3(origin_W + *distance * direction_W);
}

}  // namespace lodeline

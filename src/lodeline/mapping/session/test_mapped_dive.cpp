#include "lodeline/mapping/session/test_mapped_dive.h"

#include <cmath>
#include <utility>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/recognition/frame_geometry.h"
#include "lodeline/mapping/recognition/keyframe_describer.h"
#include "lodeline/mapping/session/keyframe_choice.h"
#include "lodeline/mapping/session/loops/loop_closures.h"
#include "simulation/dive/point_dive.h"

namespace lodeline {
namespace {

Rig givenRig(Rig rig, const MappedDiveOptions& options) {
  for (CameraCalibration& camera : rig.cameras) {
    camera.fx_px *= 1.0 + options.focal_length_error;
    camera.fy_px *= 1.0 + options.focal_length_error;
  }
  Rigid3& second = rig.cameras.back().body_from_camera;
  const Vec3 baseline = second.translation - rig.cameras.front().body_from_camera.translation;
  second.translation += options.baseline_error * baseline;
  second.rotation = second.rotation * so3::exp(options.rotation_error_rad * Vec3(0.6, -0.5, 0.6));
  return rig;
}

/// The descriptor of a physical point, the same in all dives of a cave; some share that of another point.
Descriptor descriptorOf(int point, const MappedDiveOptions& options) {
  Random choice(options.cave.seed, "alike/" + std::to_string(point));
  if (choice.uniform(0.0, 1.0) < options.alike_share) point %= 40;
  Random bits(options.cave.seed, "descriptor/" + std::to_string(point));
  Descriptor descriptor;
  for (uint64_t& word : descriptor.bits) {
    for (int i = 0; i < 64; ++i) word |= static_cast<uint64_t>(bits.uniform(0.0, 1.0) < 0.5) << i;
  }
  return descriptor;
}

Descriptor withWrongBits(Descriptor descriptor, double share, Random& random) {
  for (uint64_t& word : descriptor.bits) {
    for (int i = 0; i < 64; ++i) word ^= static_cast<uint64_t>(random.uniform(0.0, 1.0) < share) << i;
  }
  return descriptor;
}

/// Makes keyframes from the tracks of a simulation of points.
class KeyframeMaker {
 public:
  KeyframeMaker(const Rig& rig, const MappedDiveOptions& options)
      : options_(options), random_(options.dive_seed, "mapped_dive/bits") {
    for (const CameraCalibration& camera : rig.cameras) cameras_.push_back(makeCamera(camera));
  }

  MapKeyframe make(const FrameTracks& tracks, const FrameEstimate& estimate, const Estimator& estimator,
                   const PointSimulation& simulation) {
    const FrameGeometry geometry = frameGeometry(estimator, cameras_, tracks);
    MapKeyframe keyframe = keyframeOf(estimate);
    for (const FeatureObservation& seen : tracks.observations) {
      const auto ray = geometry.rayOf(seen.camera, seen.pixel, seen.sigma_px);
      if (!ray) continue;
      const bool is_known = !keyframe.features.empty() && keyframe.features.back().track == seen.track;
      if (!is_known) {
        if (seen.camera != 0) continue;
        MapFeature feature;
        feature.track = seen.track;
        feature.descriptor = withWrongBits(descriptorOf(simulation.pointOf(seen.track), options_),
                                           options_.wrong_bits, random_);
        if (const TrackPoint* point = geometry.find(seen.track)) {
          feature.point_B = point->point_B;
          feature.distance_sigma_m = point->distance_sigma_m;
        }
        keyframe.features.push_back(feature);
      }
      keyframe.features.back().rays.push_back(*ray);
    }
    return keyframe;
  }
  const std::vector<std::shared_ptr<const Camera>>& cameras() const { return cameras_; }

 private:
  MappedDiveOptions options_;
  Random random_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
};

/// Sees the tags on the line of a cave, as TagObserver does in images.
class TagViewer {
 public:
  TagViewer(const Rig& true_rig, const MappedDiveOptions& options)
      : options_(options),
        random_(options.dive_seed, "mapped_dive/tags"),
        camera_(makeCamera(true_rig.cameras.front())),
        calibration_(true_rig.cameras.front()) {
    const CavePlan plan = planCave(options.cave);
    tags_ = placeTags(plan.cave, plan.line, options.tags, options.cave.seed);
  }

  std::vector<SeenTag> look(const Rigid3& cave_from_body) {
    std::vector<SeenTag> seen;
    for (const LineTag& tag : tags_) {
      const Rigid3 body_from_tag = cave_from_body.inverse() * tag.cave_from_tag;
      if (!isVisible(body_from_tag)) continue;
      const Vec3 ray = body_from_tag.translation.normalized();
      const double distance_m = body_from_tag.translation.norm();
      const double along_m = kAlong * distance_m, across_m = kAcross * distance_m;
      const Vec3 error = across_m * random_.normal3() + along_m * random_.normal() * ray;
      const auto number = options_.tag_numbers.find(tag.id);
      seen.push_back({number == options_.tag_numbers.end() ? tag.id : number->second,
                      body_from_tag.translation + error,
                      across_m * across_m * Mat3::Identity() + along_m * along_m * ray * ray.transpose()});
    }
    return seen;
  }

 private:
  static constexpr double kAlong = 0.02, kAcross = 0.003;  // one sigma over the distance

  bool isVisible(const Rigid3& body_from_tag) const {
    const Vec3 centre_C = calibration_.body_from_camera.inverse() * body_from_tag.translation;
    const Vec3 out_C =
        calibration_.body_from_camera.rotation.conjugate() * (body_from_tag.rotation * Vec3::UnitZ());
    if (centre_C.z() < 0.3 || centre_C.norm() > 3.0) return false;
    if (-out_C.dot(centre_C.normalized()) < 0.5) return false;
    const auto pixel = camera_->project(centre_C);
    return pixel && pixel->x() > 40 && pixel->y() > 40 && pixel->x() < calibration_.width_px - 40 &&
           pixel->y() < calibration_.height_px - 40;
  }

  MappedDiveOptions options_;
  Random random_;
  std::shared_ptr<const Camera> camera_;
  CameraCalibration calibration_;
  std::vector<LineTag> tags_;
};

MappedScene sceneOf(const MappedDiveOptions& wanted) {
  MountedRig mounted = standardRig({});
  const ImuErrors imu = drawImuErrors(imuGrade("gx5-25"), {}, wanted.dive_seed);
  mounted.rig.imu.noise = statedNoise(imu);
  DiveMotionOptions motion;
  motion.seed = wanted.dive_seed;
  motion.duration_s = (wanted.cave.path_length_m + 22.0) / wanted.speed_m_per_s;
  PointDive dive = makeCaveDive(wanted.cave, motion, mounted, imu);
  PointSimulationOptions points;
  points.seed = wanted.dive_seed;
  points.frame_rate_hz = wanted.frame_rate_hz;
  points.tracks = wanted.tracks;
  points.imu = imu;
  return {std::move(dive.motion),
          std::move(dive.landmarks),
          dive.mounted.rig,
          givenRig(dive.mounted.rig, wanted),
          points,
          dive.cave_origin_W};
}

}  // namespace

MappedDive::MappedDive(const MappedDiveOptions& wanted, const std::filesystem::path& file,
                       const MapFile* earlier)
    : MappedDive(sceneOf(wanted), wanted, file, earlier) {}

MappedDive::MappedDive(const MappedScene& scene, const MappedDiveOptions& wanted,
                       const std::filesystem::path& file, const MapFile* earlier) {
  cave_origin_W = scene.cave_origin_W;
  rig = scene.given_rig;
  options = wanted.estimator;
  PointSimulation simulation(scene.motion, scene.landmarks, scene.true_rig, rig, scene.points);
  Diagnostics diagnostics;
  Estimator estimator(rig, options, &diagnostics);
  TruthComparison comparison;
  KeyframeChoice choice(KeyframeChoiceOptions{});
  KeyframeMaker maker(rig, wanted);
  TagViewer viewer(scene.true_rig, wanted);
  MapFile own = MapFile::create(file, {});
  MapDive row;
  row.name = file.stem().string();
  DiveMapping mapping(&own, row, earlier, wanted.mapping);
  Rigid3 map_from_odom;
  bool placed = earlier == nullptr;
  std::map<KeyframeId, Rigid3> true_in_odometry;
  Time last;
  while (const auto frame = simulation.next()) {
    const FrameEstimate estimate =
        estimator.add(frame->tracks, frame->imu, SensorReadings(frame->magnetometer));
    record.add(frame->tracks, frame->imu, estimate, estimator);
    const Comparison compared = comparison.compare(*frame, estimate, estimator);
    if (!compared.initialized()) continue;
    last = estimate.time;
    if (choice.add(estimate)) {
      record.keepNewest();
      MapKeyframe keyframe = maker.make(frame->tracks, estimate, estimator, simulation);
      if (!wanted.recognizes_places) keyframe.features.clear();
      Rigid3 cave_from_body = frame->truth.motion.world_from_body;
      cave_from_body.translation -= cave_origin_W;
      keyframe.tags = viewer.look(cave_from_body);
      const MappingStep step = mapping.add(keyframe);
      true_in_odometry[step.keyframe] = compared.true_world_from_body;
      true_poses[step.keyframe] = cave_from_body;
      accepted.insert(accepted.end(), step.accepted.begin(), step.accepted.end());
      map_from_odom = step.map_from_odom;
      placed = step.is_placed;
    }
    times.push_back(estimate.time);
    truth.push_back(compared.true_world_from_body);
    true_in_simulation.push_back(frame->truth.motion.world_from_body);
    odometry.push_back(estimate.state.world_from_body);
    in_map.push_back(map_from_odom * estimate.state.world_from_body);
    is_placed.push_back(placed);
  }
  record.finish(estimator);
  summary = mapping.finish(last);
  ledger = mapping.ledger();
  closures = loopClosures(accepted, mapping.known(), mapping.dive(), maker.cameras());
  for (const Loop& loop : ledger) {
    if (loop.status != LoopStatus::Accepted || true_in_odometry.count(loop.old_keyframe) == 0) continue;
    const Rigid3 true_relative =
        true_in_odometry.at(loop.old_keyframe).inverse() * true_in_odometry.at(loop.new_keyframe);
    loop_errors_m.push_back((true_relative.translation - loop.old_from_new.translation).norm());
    loop_errors_squared.push_back(mahalanobisSquared(loop.old_from_new, true_relative, loop.covariance));
  }
  for (const VerifiedLoop& verified : accepted) {
    const Time closed = mapping.known().at(verified.loop.new_keyframe).time;
    if (!first_loop || closed < *first_loop) first_loop = closed;
  }
}

double positionRms(const std::vector<Rigid3>& poses, const std::vector<Rigid3>& truth) {
  double sum = 0.0;
  for (size_t i = 0; i < poses.size(); ++i)
    sum += (poses[i].translation - truth[i].translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(std::max<size_t>(1, poses.size())));
}

}  // namespace lodeline

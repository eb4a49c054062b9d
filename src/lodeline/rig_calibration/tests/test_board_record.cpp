#include "lodeline/rig_calibration/tests/test_board_record.h"

#include "lodeline/cameras/camera.h"
#include "simulation/dive/dive.h"

namespace lodeline::test {
namespace {

Dive diveOf(const BoardTrial& trial) {
  ScenarioChanges changes;
  changes.seconds = trial.duration_s;
  changes.seed = trial.seed;
  if (!trial.camera_model.empty()) changes.camera_model = trial.camera_model;
  return makeDive(makeScenario("board", changes));
}

Rig rigOf(const Dive& dive, const BoardTrial& trial) {
  Rig rig = dive.errors.truth.rig;
  rig.imu = dive.errors.given.imu;
  for (CameraCalibration& camera : rig.cameras) {
    camera.time_offset_to_imu_s = trial.delay_s;
    camera.port = trial.port;
    if (!trial.port) continue;
    camera.fx_px /= trial.port->index_water;
    camera.fy_px /= trial.port->index_water;
  }
  return rig;
}

/// All corners of the tags that are completely in the image.
std::vector<BoardCorner> cornersSeen(const Camera& camera, const CalibrationBoard& board,
                                     const Rigid3& camera_from_board, double sigma_px, Random& random) {
  std::vector<BoardCorner> seen;
  for (int tag = 0; tag < board.tagCount(); ++tag) {
    std::vector<BoardCorner> corners;
    for (int index = 4 * tag; index < 4 * tag + 4; ++index) {
      const auto pixel = camera.project(camera_from_board * board.corner_T(index));
      if (pixel && camera.contains(*pixel, 6.0)) corners.push_back({index, *pixel});
    }
    if (corners.size() < 4) continue;
    for (BoardCorner& corner : corners) corner.pixel += sigma_px * Vec2(random.normal(), random.normal());
    seen.insert(seen.end(), corners.begin(), corners.end());
  }
  return seen.size() < 4 * BoardDetector::kLeastTags ? std::vector<BoardCorner>() : seen;
}

MotionState stateAt(const Dive& dive, const BoardTrial& trial, double time_s) {
  if (!trial.frozen_at_s) return dive.motion.at(time_s);
  MotionState state;
  state.world_from_body = dive.motion.at(*trial.frozen_at_s).world_from_body;
  return state;
}

}  // namespace

Rig trueRig(const BoardTrial& trial) { return rigOf(diveOf(trial), trial); }

BoardRecord boardRecord(const BoardTrial& trial) {
  const Dive dive = diveOf(trial);
  BoardRecord record;
  record.board = dive.board->board;
  record.rig = rigOf(dive, trial);
  record.has_lens.assign(record.rig.cameras.size(), true);
  record.searched.assign(record.rig.cameras.size(), 0);
  Random random(trial.seed, "board/trial");
  std::vector<std::shared_ptr<const Camera>> cameras;
  for (const CameraCalibration& camera : record.rig.cameras) cameras.push_back(makeCamera(camera));
  for (double t = 0.3; t < trial.duration_s - 0.3; t += 1.0 / trial.frame_rate_hz) {
    BoardFrame frame{dive.start + Duration::fromSeconds(t - trial.delay_s), {}};
    const Rigid3 world_from_body = stateAt(dive, trial, t).world_from_body;
    for (size_t k = 0; k < cameras.size(); ++k) {
      ++record.searched[k];
      const Rigid3 camera_from_board =
          (world_from_body * record.rig.cameras[k].body_from_camera).inverse() * dive.board->world_from_board;
      std::vector<BoardCorner> corners =
          cornersSeen(*cameras[k], record.board, camera_from_board, trial.pixel_sigma_px, random);
      if (!corners.empty()) frame.views.push_back({k, std::move(corners)});
    }
    if (!frame.views.empty()) record.frames.push_back(std::move(frame));
  }
  const double rate_hz = record.rig.imu.rate_hz;
  ImuModel imu(dive.errors.imu, rate_hz, trial.seed);
  for (double t = 0.0; t < trial.duration_s; t += 1.0 / rate_hz) {
    record.imu.push_back(imu.measure(
        perfectImuSample(stateAt(dive, trial, t), dive.start + Duration::fromSeconds(t), dive.gravity_W)));
  }
  return record;
}

}  // namespace lodeline::test

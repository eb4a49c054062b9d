#include "lodeline/rig_calibration/start/camera_start.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/start/view_pose.h"

namespace lodeline {
namespace {

constexpr size_t kTrialViews = 12;  // that choose the focal length
constexpr double kMostError_px = 12.0;
constexpr double kWorstStatedLens_px = 4.0;  // with which a stated lens is still a start

std::vector<const BoardView*> viewsOf(const BoardRecord& record, size_t camera) {
  std::vector<const BoardView*> views;
  for (const BoardFrame& frame : record.frames) {
    if (const BoardView* view = frame.viewOf(camera)) views.push_back(view);
  }
  return views;
}

/// Mean of the views' median errors with a lens; infinite where it is no lens.
double lensError_px(const CameraCalibration& lens, const BoardRecord& record,
                    const std::vector<const BoardView*>& views) {
  std::shared_ptr<const Camera> camera;
  try {
    camera = makeCamera(lens);
  } catch (const InputError&) {
    return std::numeric_limits<double>::infinity();
  }
  const size_t stride = std::max<size_t>(1, views.size() / kTrialViews);
  double sum_px = 0.0;
  int count = 0;
  for (size_t i = 0; i < views.size(); i += stride) {
    const auto pose = cameraFromBoard(*camera, record.board, views[i]->corners);
    const double error_px =
        pose ? medianError_px(*camera, record.board, views[i]->corners, *pose) : kMostError_px;
    sum_px += std::min(error_px, kMostError_px);
    ++count;
  }
  return count > 0 ? sum_px / count : std::numeric_limits<double>::infinity();
}

CameraCalibration guessedLens(const CameraCalibration& sized, const CameraModel& model,
                              const BoardRecord& record, const std::vector<const BoardView*>& views) {
  CameraCalibration best = sized;
  double least_px = std::numeric_limits<double>::infinity();
  for (double share = 0.25; share < 3.0; share *= 1.12) {
    CameraCalibration lens = sized;
    lens.model = model.name;
    const bool is_polynomial = model.before_focal_lengths == 0 && model.parameters.size() >= 4;
    lens.distortion = is_polynomial ? std::vector<double>(std::max<size_t>(4, model.counts.front()), 0.0)
                                    : model.typical.parameters;
    lens.fx_px = lens.fy_px = share * sized.width_px;
    lens.cx_px = 0.5 * (sized.width_px - 1);
    lens.cy_px = 0.5 * (sized.height_px - 1);
    const double error_px = lensError_px(lens, record, views);
    if (error_px < least_px) {
      least_px = error_px;
      best = lens;
    }
  }
  return best;
}

CameraCalibration firstLens(size_t camera, const BoardRecord& record, const LensStart& lens_start,
                            Diagnostics* diagnostics) {
  const CameraCalibration& stated = record.rig.cameras[camera];
  const std::vector<const BoardView*> views = viewsOf(record, camera);
  if (views.empty()) {
    throw EstimationError(
        fmt::format("{}: no board found in {} images. Looked for {}. Leave the camera out with --cameras, or "
                    "show it the board",
                    stated.name, record.searched[camera], boardWords(record.board)));
  }
  if (lens_start.keeps_lens) {
    if (record.has_lens[camera]) return stated;
    throw InputError(stated.name + ": no file states a lens to keep; give one with --rig");
  }
  const std::string& model_name = lens_start.model;
  const CameraModel* model = findCameraModel(model_name.empty() ? stated.model : model_name);
  const bool keeps_model = record.has_lens[camera] && (model_name.empty() || model->name == stated.model);
  if (keeps_model) {
    const double error_px = lensError_px(stated, record, views);
    if (error_px < kWorstStatedLens_px) return stated;
    diagnostics->report(Severity::Warning, "stated_lens_wrong",
                        fmt::format("{}: the stated lens leaves {:.1f} px; the calibration starts without it",
                                    stated.name, error_px));
  }
  if (model_name.empty() && !record.has_lens[camera]) model = findCameraModel("radial-tangential");
  return guessedLens(stated, *model, record, views);
}

/// Poses of the board in the cameras, by frame and camera.
using ViewPoses = std::vector<std::map<size_t, Rigid3>>;

ViewPoses poseViews(const BoardRecord& record, const std::vector<CameraState>& cameras) {
  ViewPoses poses;
  for (const BoardFrame& frame : record.frames) {
    auto& of_frame = poses.emplace_back();
    for (const BoardView& view : frame.views) {
      const Camera& camera = *cameras[view.camera].camera;
      const auto pose = cameraFromBoard(camera, record.board, view.corners);
      if (pose && medianError_px(camera, record.board, view.corners, *pose) < kMostError_px)
        of_frame[view.camera] = *pose;
    }
  }
  return poses;
}

double distanceBetween(const Rigid3& a, const Rigid3& b) {
  constexpr double kRadiansPerMetre = 3.0;
  return so3::log(a.rotation.conjugate() * b.rotation).norm() +
         kRadiansPerMetre * (a.translation - b.translation).norm();
}

/// The transformation with the least sum of distances to the others: single views may be far off.
Rigid3 medoid(const std::vector<Rigid3>& candidates) {
  constexpr size_t kMost = 80;
  const size_t stride = std::max<size_t>(1, candidates.size() / kMost);
  double least = std::numeric_limits<double>::infinity();
  Rigid3 best;
  for (size_t i = 0; i < candidates.size(); i += stride) {
    double sum = 0.0;
    for (size_t k = 0; k < candidates.size(); k += stride)
      sum += distanceBetween(candidates[i], candidates[k]);
    if (sum < least) {
      least = sum;
      best = candidates[i];
    }
  }
  return best;
}

/// Places the cameras on the first one, each by the placed camera with which it shares most views.
void placeCameras(const ViewPoses& poses, std::vector<CameraState>* cameras) {
  std::vector<std::optional<Rigid3>> placed(cameras->size());
  placed[0] = Rigid3();
  for (size_t round = 1; round < cameras->size(); ++round) {
    size_t best_camera = 0;
    std::vector<Rigid3> best;
    for (size_t k = 1; k < cameras->size(); ++k) {
      for (size_t j = 0; j < cameras->size() && !placed[k]; ++j) {
        if (!placed[j]) continue;
        std::vector<Rigid3> shared;
        for (const auto& frame : poses) {
          if (frame.contains(j) && frame.contains(k))
            shared.push_back(*placed[j] * frame.at(j) * frame.at(k).inverse());
        }
        if (shared.size() > best.size()) {
          best = std::move(shared);
          best_camera = k;
        }
      }
    }
    if (best.empty()) {
      const auto lost = std::find(placed.begin(), placed.end(), std::nullopt) - placed.begin();
      throw EstimationError(fmt::format(
          "{} never sees the board at the same time as another camera; show the board to both, or "
          "leave the camera out with --cameras",
          (*cameras)[static_cast<size_t>(lost)].base.name));
    }
    placed[best_camera] = medoid(best);
    poseToBlock(*placed[best_camera], (*cameras)[best_camera].body_from_camera.data());
  }
}

}  // namespace

RigState startCameras(const BoardRecord& record, const LensStart& lens_start, Diagnostics* diagnostics) {
  RigState state;
  for (size_t camera = 0; camera < record.rig.cameras.size(); ++camera) {
    CameraCalibration lens = firstLens(camera, record, lens_start, diagnostics);
    lens.body_from_camera = Rigid3();
    state.cameras.emplace_back(lens);
  }
  const ViewPoses poses = poseViews(record, state.cameras);
  placeCameras(poses, &state.cameras);
  for (size_t f = 0; f < record.frames.size(); ++f) {
    if (poses[f].empty()) continue;
    // The camera with the most corners gives the pose.
    const BoardView* widest = nullptr;
    for (const BoardView& view : record.frames[f].views) {
      if (poses[f].contains(view.camera) && (!widest || view.corners.size() > widest->corners.size()))
        widest = &view;
    }
    const Rigid3 body_from_camera = poseFromBlock(state.cameras[widest->camera].body_from_camera.data());
    FrameState frame;
    frame.seen = &record.frames[f];
    poseToBlock((body_from_camera * poses[f].at(widest->camera)).inverse(), frame.world_from_body.data());
    state.frames.push_back(frame);
  }
  if (state.frames.empty())
    throw EstimationError("no lens fits the views of the board; check the size of the tags in its file");
  return state;
}

}  // namespace lodeline

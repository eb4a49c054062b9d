#include "lodeline/output/live/live_view.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lodeline/output/files/sample_pictures.h"
#include "lodeline/output/report/data/base64.h"
#include "lodeline/output/report/page/report_page.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

constexpr std::chrono::milliseconds kStatePause(100);
constexpr std::chrono::milliseconds kPicturePause(500);
/// Ratio of the pause after a picture to the time of making it. It limits the picture's share of the
/// computing time on any machine.
constexpr int kPauseToWork = 120;
constexpr int kPictureWidth_px = 480;
/// Enough to show walls; the report contains those of the whole dive.
constexpr size_t kMostLandmarks = 40;

/// Values under the names of states.csv, so that the page can treat both alike.
nlohmann::ordered_json numbersOf(const FrameEstimate& estimate) {
  const Vec3& p = estimate.state.world_from_body.translation;
  const Quat& q = estimate.state.world_from_body.rotation;
  const Eigen::VectorXd sigma = estimate.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {{"p_x [m]", shortNumber(p.x())},
          {"p_y [m]", shortNumber(p.y())},
          {"p_z [m]", shortNumber(p.z())},
          {"q_w", shortNumber(q.w())},
          {"q_x", shortNumber(q.x())},
          {"q_y", shortNumber(q.y())},
          {"q_z", shortNumber(q.z())},
          {"sigma_p_x [m]", shortNumber(sigma[0])},
          {"sigma_p_y [m]", shortNumber(sigma[1])},
          {"sigma_p_z [m]", shortNumber(sigma[2])},
          {"sigma_heading [rad]", shortNumber(estimate.sensors.of<MagnetometerEstimate>().heading_sigma_rad)},
          {"tracks", estimate.tracks},
          {"landmarks", estimate.landmarks},
          {"reprojection_rms [sigma]", shortNumber(estimate.reprojection_rms_sigmas)}};
}

/// Pose of the body and azimuth of the odometry's world in the map.
nlohmann::ordered_json mapPose(const FrameEstimate& estimate, const Rigid3& map_from_world) {
  const Vec3 p = map_from_world * estimate.state.world_from_body.translation;
  const Vec3 east = map_from_world.rotation * Vec3::UnitX();
  return {{"x_m", shortNumber(p.x())},
          {"y_m", shortNumber(p.y())},
          {"z_m", shortNumber(p.z())},
          {"turned_rad", shortNumber(std::atan2(east.y(), east.x()))}};
}

Vec3 cameraAxis_B(const Rig& rig) { return rig.cameras.front().body_from_camera.rotation * Vec3::UnitZ(); }

}  // namespace

std::string livePage(const std::string& name, const std::string& data, const Vec3& camera_axis_B) {
  const Vec3& axis = camera_axis_B;
  return fillPage({{"live", true},
                   {"name", name},
                   {"data", data},
                   {"camera_axis_B", {axis.x(), axis.y(), axis.z()}},
                   {"runs", nlohmann::ordered_json::array()}});
}

std::string liveState(const FrameEstimate& estimate, const RunSummary& summary, double t_s,
                      const std::vector<Eigen::Vector3f>& landmarks_W,
                      const std::optional<Rigid3>& map_from_world) {
  nlohmann::ordered_json json;
  json["t_s"] = shortNumber(t_s);
  const bool has_pose = estimate.status != Status::Waiting;
  if (has_pose) json["numbers"] = numbersOf(estimate);
  if (has_pose && map_from_world) json["map"] = mapPose(estimate, *map_from_world);
  const auto& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  json["words"] = {{"status", toString(estimate.status)}, {"magnetometer", toString(magnetometer.status)}};
  json["run"] = {{"frames", summary.frames()},
                 {"path_m", shortNumber(summary.pathLength_m())},
                 {"real_time_factor", shortNumber(summary.realTimeFactor())},
                 {"heading_reference", toString(magnetometer.heading_reference)},
                 {"waiting_for", estimate.waiting_for}};
  const std::optional<double>& north_rad = magnetometer.north_from_world_rad;
  json["run"]["north_from_world_rad"] =
      north_rad ? nlohmann::ordered_json(*north_rad) : nlohmann::ordered_json();
  if (!landmarks_W.empty()) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(landmarks_W.data());
    json["landmarks"] = base64({bytes, landmarks_W.size() * sizeof(Eigen::Vector3f)});
  }
  return jsonText(json, -1);
}

LiveView::LiveView(const std::string& address, int port, const std::string& name, const std::string& data,
                   const Rig& rig)
    : server_(address, port, livePage(name, data, cameraAxis_B(rig))) {}

LiveView::~LiveView() { server_.send("end", "{}"); }

std::vector<Eigen::Vector3f> LiveView::takeLandmarks() {
  std::vector<Eigen::Vector3f> taken;
  const size_t every = (landmarks_W_.size() + kMostLandmarks - 1) / kMostLandmarks;
  for (size_t i = 0; i < landmarks_W_.size(); i += every) taken.push_back(landmarks_W_[i]);
  landmarks_W_.clear();
  return taken;
}

void LiveView::show(const FramePacket& packet, const FrameEstimate& estimate, const RunSummary& summary,
                    const FrontEnd& front_end, const std::vector<MapPoint>& landmarks,
                    const std::optional<Rigid3>& map_from_world) {
  for (const MapPoint& landmark : landmarks) landmarks_W_.push_back(landmark.position_W.cast<float>());
  if (!first_time_) first_time_ = packet.time;
  const double t_s = (packet.time - *first_time_).seconds();
  const Clock::time_point now = Clock::now();
  if (now >= next_state_) {
    next_state_ = now + kStatePause;
    server_.sendAndKeep("state", liveState(estimate, summary, t_s, takeLandmarks(), map_from_world));
  }
  if (now < next_picture_ || !server_.isWatched()) return;
  const std::vector<uint8_t> jpeg = trackPicture(packet, front_end, kPictureWidth_px);
  if (jpeg.empty()) return;
  const nlohmann::ordered_json json = {{"t_s", shortNumber(t_s)}, {"jpeg", base64(jpeg)}};
  server_.send("picture", jsonText(json, -1));
  const Clock::time_point done = Clock::now();
  next_picture_ = done + std::max<Clock::duration>(kPicturePause, kPauseToWork * (done - now));
}

}  // namespace lodeline

#include "lodeline/output/report/page/solutions.h"

#include <algorithm>
#include <array>

#include "lodeline/output/report/page/table_json.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Stamps of one frame in two files are the same but for rounding.
constexpr int64_t kSameMoment_ns = 1000;

/// Columns that show where a run was and how well that is known.
bool isOfPose(const std::string& column) {
  for (const char* beginning : {"p_", "q_", "sigma_p_", "sigma_heading", "sigma_theta_z"}) {
    if (column.rfind(beginning, 0) == 0) return true;
  }
  return column.rfind("cov_", 0) == 0 && isForThePage(column);
}

constexpr std::array<const char*, 3> kPosition = {"p_x [m]", "p_y [m]", "p_z [m]"};
constexpr std::array<const char*, 4> kRotation = {"q_w", "q_x", "q_y", "q_z"};

Rigid3 poseIn(const RunTable& states, size_t row) {
  std::array<double, 7> v;
  for (size_t k = 0; k < 3; ++k) v[k] = states.numbers.at(kPosition[k])[row];
  for (size_t k = 0; k < 4; ++k) v[3 + k] = states.numbers.at(kRotation[k])[row];
  return {Quat(v[3], v[4], v[5], v[6]).normalized(), Vec3(v[0], v[1], v[2])};
}

/// What a keyframe says of the place of the odometry's world in the map.
struct Correction {
  int64_t stamp_ns = 0;
  Rigid3 map_from_world;
};

std::vector<Correction> correctionsOf(const std::vector<StampedPose>& keyframes, const RunTable& states) {
  std::vector<Correction> corrections;
  for (const StampedPose& keyframe : keyframes) {
    const int64_t stamp_ns = keyframe.time.nanoseconds();
    const auto found =
        std::lower_bound(states.stamp_ns.begin(), states.stamp_ns.end(), stamp_ns - kSameMoment_ns);
    if (found == states.stamp_ns.end() || *found > stamp_ns + kSameMoment_ns) continue;
    const Rigid3 world_from_body = poseIn(states, static_cast<size_t>(found - states.stamp_ns.begin()));
    if (!world_from_body.translation.allFinite()) continue;
    corrections.push_back({*found, keyframe.world_from_body * world_from_body.inverse()});
  }
  return corrections;
}

/// Between two keyframes, the share of the way from one correction of a pose to the other; before the first
/// and after the last, theirs.
Rigid3 corrected(const std::vector<Correction>& corrections, int64_t stamp_ns,
                 const Rigid3& world_from_body) {
  const auto next = std::lower_bound(corrections.begin(), corrections.end(), stamp_ns,
                                     [](const Correction& c, int64_t t) { return c.stamp_ns < t; });
  if (next == corrections.begin()) return next->map_from_world * world_from_body;
  const auto last = std::prev(next);
  const Rigid3 a = last->map_from_world * world_from_body;
  if (next == corrections.end()) return a;
  const Rigid3 b = next->map_from_world * world_from_body;
  const double share =
      static_cast<double>(stamp_ns - last->stamp_ns) / static_cast<double>(next->stamp_ns - last->stamp_ns);
  return {a.rotation.slerp(share, b.rotation), a.translation + share * (b.translation - a.translation)};
}

/// The poses of the states in the map, under the names of states.csv. The map places keyframes; a pose
/// between two of them follows by odometry. Empty where no keyframe has the time of a state.
RunTable statesInMap(const std::vector<StampedPose>& keyframes, const RunTable& states) {
  const std::vector<Correction> corrections = correctionsOf(keyframes, states);
  RunTable table;
  if (corrections.empty()) return table;
  for (size_t row = 0; row < states.rows(); ++row) {
    const Rigid3 world_from_body = poseIn(states, row);
    if (!world_from_body.translation.allFinite()) continue;
    const Rigid3 pose = corrected(corrections, states.stamp_ns[row], world_from_body);
    const std::array<double, 4> q = {pose.rotation.w(), pose.rotation.x(), pose.rotation.y(),
                                     pose.rotation.z()};
    table.stamp_ns.push_back(states.stamp_ns[row]);
    for (size_t k = 0; k < 3; ++k)
      table.numbers[kPosition[k]].push_back(pose.translation[static_cast<Eigen::Index>(k)]);
    for (size_t k = 0; k < 4; ++k) table.numbers[kRotation[k]].push_back(q[k]);
  }
  return table;
}

/// Empty where there is no file, or one without content.
std::vector<StampedPose> keyframesOf(const fs::path& file, Diagnostics* diagnostics) {
  std::error_code error;
  if (fs::file_size(file, error) == 0 || error) return {};
  TrajectoryReadOptions options;
  options.format = TrajectoryFormat::Tum;
  return readTrajectory(file, options, *diagnostics).poses;
}

}  // namespace

bool isForThePage(const std::string& column) {
  static const std::array<std::string, 6> kOfPosition = {"cov_pose_00", "cov_pose_01", "cov_pose_02",
                                                         "cov_pose_11", "cov_pose_12", "cov_pose_22"};
  if (std::find(kOfPosition.begin(), kOfPosition.end(), column) != kOfPosition.end()) return true;
  for (const char* beginning : {"cov_", "attitude_", "keyframe", "posterior_"}) {
    if (column.rfind(beginning, 0) == 0) return false;
  }
  return true;
}

nlohmann::ordered_json otherSolutionsJson(const fs::path& run, bool is_refined, int64_t origin_ns,
                                          size_t most_rows, Diagnostics* diagnostics) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const std::vector<StampedPose> keyframes = keyframesOf(run / "keyframes_map.tum", diagnostics);
  if ((!is_refined && keyframes.empty()) || !fs::exists(run / "states.csv")) return json;
  Diagnostics reported_with_the_states;
  const RunTable states =
      readRunTable(run / "states.csv", is_refined ? diagnostics : &reported_with_the_states);
  if (is_refined)
    json.push_back({{"kind", "run"}, {"states", tableJson(states, origin_ns, most_rows, isOfPose)}});
  const RunTable in_map = statesInMap(keyframes, states);
  if (in_map.rows() > 0)
    json.push_back({{"kind", "map"}, {"states", tableJson(in_map, origin_ns, most_rows)}});
  return json;
}

}  // namespace lodeline

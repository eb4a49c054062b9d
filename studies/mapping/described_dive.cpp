#include "studies/mapping/described_dive.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <map>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/mapping/recognition/keyframe_describer.h"
#include "lodeline/mapping/session/keyframe_choice.h"
#include "lodeline/util/thread_clock.h"

namespace lodeline {
namespace {

/// True poses of the body by time, in axes of the cave.
std::map<Time, Rigid3> readTruth(const std::filesystem::path& folder) {
  const YAML::Node cave = YAML::LoadFile((folder / "truth/cave.yaml").string())["world_from_cave_m"];
  const Vec3 world_from_cave(cave[0].as<double>(), cave[1].as<double>(), cave[2].as<double>());
  const auto file = folder / "mav0/state_groundtruth_estimate0/data.csv";
  std::ifstream stream(file);
  std::map<Time, Rigid3> poses;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') continue;
    for (char& character : line) character = character == ',' ? ' ' : character;
    std::istringstream row(line);
    int64_t ns = 0;
    Vec3 p;
    Quat q;
    if (row >> ns >> p.x() >> p.y() >> p.z() >> q.w() >> q.x() >> q.y() >> q.z())
      poses[Time::fromNanoseconds(ns)] = Rigid3(q.normalized(), p - world_from_cave);
  }
  if (poses.empty()) throw InputError(fmt::format("{}: no poses", file.string()));
  return poses;
}

Rigid3 poseAt(const std::map<Time, Rigid3>& truth, Time time) {
  const auto after = truth.lower_bound(time);
  if (after == truth.end()) return std::prev(after)->second;
  if (after == truth.begin()) return after->second;
  const auto before = std::prev(after);
  const double share = (time - before->first).seconds() / (after->first - before->first).seconds();
  return {before->second.rotation.slerp(share, after->second.rotation),
          (1.0 - share) * before->second.translation + share * after->second.translation};
}

}  // namespace

DescribedDive::DescribedDive(const std::filesystem::path& folder) {
  const auto truth = readTruth(folder);
  Diagnostics diagnostics;
  EurocSource source(folder, {}, &diagnostics);
  Synchronizer synchronizer(&source, {}, &diagnostics);
  PacketOdometry odometry(source.rig(), {}, &diagnostics);
  const KeyframeDescriber describer(source.rig());
  camera = describer.cameras().front();
  KeyframeChoice choice(KeyframeChoiceOptions{});
  while (auto packet = synchronizer.next()) {
    const FrameEstimate estimate = odometry.add(*packet);
    ++frames;
    if (estimate.status == Status::Waiting || packet->images[0].empty() || !choice.add(estimate)) continue;
    const double before_s = threadSeconds();
    keyframes.push_back(describer.describe(packet->images, odometry.tracks(), estimate, odometry.estimator(),
                                           odometry.frontEnd().fixedStructures()[0].mask()));
    describing_s += threadSeconds() - before_s;
    keyframes.back().id = static_cast<KeyframeId>(keyframes.size()) - 1;
    cave_from_bodies.push_back(poseAt(truth, keyframes.back().time));
    const size_t n = cave_from_bodies.size();
    if (n > 1) path_m += (cave_from_bodies[n - 1].translation - cave_from_bodies[n - 2].translation).norm();
  }
}

}  // namespace lodeline

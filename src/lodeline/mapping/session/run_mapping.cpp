#include "lodeline/mapping/session/run_mapping.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "lodeline/output/files/world_turn.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Removes a map file and what SQLite keeps beside it.
void removeMap(const fs::path& file) {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) fs::remove(file.string() + suffix);
}

/// The images of a packet that were taken at its time; empty ones in place of others.
std::vector<cv::Mat> simultaneousImages(const FramePacket& packet) {
  constexpr double kMost_s = 1e-4;
  std::vector<cv::Mat> images = packet.images;
  for (size_t camera = 1; camera < images.size(); ++camera) {
    const bool is_late =
        camera < packet.image_delays_s.size() && std::abs(packet.image_delays_s[camera]) > kMost_s;
    if (is_late) images[camera] = cv::Mat();
  }
  return images;
}

MapDive diveOf(const RunMappingRequest& request, const Rig& rig) {
  MapDive dive;
  dive.name = request.name;
  dive.recording = request.recording;
  RigFile file;
  file.rig = rig;
  file.has_imu = true;
  dive.rig = rigText(file);
  return dive;
}

}  // namespace

RunMapping::RunMapping(const RunMappingRequest& request, const Rig& rig, Diagnostics* diagnostics)
    : request_(request),
      diagnostics_(diagnostics),
      choice_(request.keyframes),
      describer_(rig),
      trajectory_(request.folder / "trajectory_map.tum") {
  if (!request_.earlier_map.empty())
    earlier_.emplace(MapFile::open(request_.earlier_map, MapFile::Access::Read));
  const fs::path file = request_.folder / "map.db";
  removeMap(file);
  own_.emplace(MapFile::create(file, {}));
  mapping_ = std::make_unique<DiveMapping>(&*own_, diveOf(request_, rig), earlier_ ? &*earlier_ : nullptr,
                                           request_.mapping);
  is_placed_ = !earlier_;
  thread_ = std::make_unique<MappingThread>(
      [this](MapKeyframe keyframe) { return mapping_->add(std::move(keyframe)); });
}

RunMapping::~RunMapping() = default;

bool RunMapping::add(const FramePacket& packet, const FrameEstimate& estimate, std::optional<Time> stamp,
                     const PacketOdometry& odometry) {
  if (estimate.status == Status::Waiting) return false;
  newest_ = estimate.state.time;
  const bool is_keyframe = !packet.images.front().empty() && choice_.add(estimate);
  if (is_keyframe) {
    const cv::Mat& rig_mask = odometry.frontEnd().fixedStructures().front().mask();
    MapKeyframe keyframe = describer_.describe(simultaneousImages(packet), odometry.tracks(), estimate,
                                               odometry.estimator(), rig_mask);
    if (const std::optional<MappingStep> step = thread_->add(std::move(keyframe))) take(*step);
  }
  if (stamp && is_placed_) trajectory_.write(*stamp, map_from_odom_ * estimate.state.world_from_body);
  return is_keyframe;
}

void RunMapping::take(const MappingStep& step) {
  map_from_odom_ = step.map_from_odom;
  is_placed_ = step.is_placed;
  accepted_.insert(accepted_.end(), step.accepted.begin(), step.accepted.end());
}

void RunMapping::writeLedger() const {
  LoopLedger ledger(request_.folder / "loops.csv");
  const KnownKeyframes& known = mapping_->known();
  std::map<int, std::string> names;
  if (earlier_) {
    for (const MapDive& dive : earlier_->dives()) names[dive.id] = dive.name;
  }
  const auto nameOf = [&](const KnownKeyframe& keyframe) {
    const auto name = names.find(keyframe.dive);
    return name == names.end() ? request_.name : name->second;
  };
  for (const Loop& loop : mapping_->ledger()) {
    const KnownKeyframe& old_keyframe = known.at(loop.old_keyframe);
    const KnownKeyframe& new_keyframe = known.at(loop.new_keyframe);
    ledger.write(loop, {nameOf(old_keyframe), nameOf(new_keyframe), old_keyframe.time, new_keyframe.time});
  }
}

MappingSummary RunMapping::finish(const MagnetometerEstimate& last) {
  for (const MappingStep& step : thread_->finish()) take(step);
  const MappingSummary summary = mapping_->finish(newest_);
  closures_ = loopClosures(accepted_, mapping_->known(), mapping_->dive(), describer_.cameras());
  writeLedger();
  if (const std::optional<WorldTurn> turn = WorldTurn::of(last); turn && !earlier_)
    turnTrajectoryFile(request_.folder / "trajectory_map.tum", *turn);
  if (!summary.is_placed) {
    diagnostics_->report(Severity::Warning, "not_in_map",
                         request_.earlier_map.string() +
                             ": no place of this map was recognized; trajectory_map.tum has no poses");
  }
  return summary;
}

}  // namespace lodeline

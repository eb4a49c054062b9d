#include "lodeline/mapping/session/run_mapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lodeline/geometry/so3.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "lodeline/mapping/session/map_solution.h"
#include "lodeline/mapping/session/tags/control_report.h"
#include "lodeline/output/files/world_turn.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Removes a map file and what SQLite keeps beside it. Throws InputError where it is no regular file.
void removeMap(const fs::path& file) {
  if (fs::exists(file) && !fs::is_regular_file(file))
    throw InputError(file.string() + ": cannot be written, as it is no regular file");
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
  dive.heading_reference = request.north;
  RigFile file;
  file.rig = rig;
  file.has_imu = true;
  dive.rig = rigText(file);
  return dive;
}

bool hasSizes(const TagOptions& tags) { return tags.size_m > 0.0 || !tags.sizes_m.empty(); }

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
  fs::remove(request_.folder / "control.csv");
  own_.emplace(MapFile::create(file, {}));
  mapping_ = std::make_unique<DiveMapping>(&*own_, diveOf(request_, rig), earlier_ ? &*earlier_ : nullptr,
                                           request_.mapping);
  is_placed_ = !earlier_;
  for (size_t i = 0; hasSizes(request_.tags) && i < rig.cameras.size(); ++i) {
    tag_observers_.emplace_back(describer_.cameras()[i], rig.cameras[i].body_from_camera, static_cast<int>(i),
                                request_.tags);
  }
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
    keyframe.tags = tagsIn(packet);
    if (const std::optional<MappingStep> step = thread_->add(std::move(keyframe))) take(*step);
  }
  if (stamp && is_placed_) {
    trajectory_.write(*stamp, map_from_odom_ * estimate.state.world_from_body);
    ++rows_;
  }
  return is_keyframe;
}

std::vector<SeenTag> RunMapping::tagsIn(const FramePacket& packet) const {
  std::vector<SeenTag> tags;
  for (size_t i = 0; i < std::min(tag_observers_.size(), packet.images.size()); ++i) {
    if (packet.images[i].empty()) continue;
    for (const TagObservation& seen : tag_observers_[i].observe(packet.images[i])) {
      // The errors of the size are the same in all cameras, so one of them speaks for all.
      const bool is_known =
          std::any_of(tags.begin(), tags.end(), [&](const SeenTag& other) { return other.tag == seen.tag; });
      if (seen.centre_B && !is_known)
        tags.push_back({seen.tag, seen.centre_B->position, seen.centre_B->covariance});
    }
  }
  return tags;
}

void RunMapping::take(const MappingStep& step) {
  map_from_odom_ = step.map_from_odom;
  is_placed_ = step.is_placed;
  if (step.has_north && !rows_before_north_) rows_before_north_ = rows_;
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

void RunMapping::writeKeyframes() const {
  PoseWriter keyframes(request_.folder / "keyframes_map.tum");
  if (!mapping_->summary().is_placed) return;
  for (const KnownKeyframe& keyframe : mapping_->known().all()) {
    if (keyframe.dive == mapping_->dive()) keyframes.write(keyframe.time, keyframe.map_from_body);
  }
}

std::optional<Rigid3> RunMapping::mapFromOdom(const FrameEstimate& newest) const {
  if (!is_placed_) return std::nullopt;
  const auto& north_rad = newest.sensors.of<MagnetometerEstimate>().north_from_world_rad;
  if (earlier_ || rows_before_north_ || !north_rad) return map_from_odom_;
  return Rigid3(so3::exp(*north_rad * Vec3::UnitZ()), Vec3::Zero()) * map_from_odom_;
}

void RunMapping::solveForStatedTags() {
  std::set<int64_t> seen;
  for (const ControlObservation& observation : own_->controlObservations()) seen.insert(observation.point);
  const std::vector<ControlPoint> points = own_->controlPoints();
  const bool is_stated = std::any_of(points.begin(), points.end(), [&](const ControlPoint& point) {
    return point.position && seen.count(point.id) > 0;
  });
  if (!is_stated) return;
  try {
    solveMap(&*own_, {request_.mapping.graph, request_.mapping.factors});
  } catch (const EstimationError& error) {
    diagnostics_->report(Severity::Warning, "tags_not_solved",
                         std::string("the positions of tags do not place the map: ") + error.what());
    return;
  }
  const auto poseOf = [this](KeyframeId id) { return own_->keyframe(id)->solved; };
  for (const std::string& text : blunderTexts(controlResiduals(controlFactorsOf(*own_), poseOf)))
    diagnostics_->report(Severity::Warning, "tag_refused", text);
}

void RunMapping::reportTags() const {
  const KnownKeyframes& known = mapping_->known();
  for (const Loop& loop : mapping_->ledger()) {
    if (loop.source != kTagSource || loop.status != LoopStatus::Refused) continue;
    diagnostics_->report(
        Severity::Warning, "tag_refused",
        fmt::format("at {} ns: {}", known.at(loop.new_keyframe).time.nanoseconds(), loop.reason));
  }
}

MappingSummary RunMapping::finish(const MagnetometerEstimate& last) {
  for (const MappingStep& step : thread_->finish()) take(step);
  mapping_->setHeadingReference(last.heading_reference);
  const MappingSummary summary = mapping_->finish(newest_);
  closures_ = loopClosures(accepted_, mapping_->known(), mapping_->dive(), describer_.cameras());
  writeLedger();
  writeKeyframes();
  solveForStatedTags();
  writeControlReport(request_.folder / "control.csv", *own_);
  reportTags();
  if (const std::optional<WorldTurn> turn = WorldTurn::of(last); turn && !earlier_)
    turnTrajectoryFile(request_.folder / "trajectory_map.tum", *turn, rows_before_north_.value_or(rows_));
  if (!summary.is_placed) {
    diagnostics_->report(Severity::Warning, "not_in_map",
                         request_.earlier_map.string() +
                             ": no place of this map was recognized; trajectory_map.tum has no poses");
  }
  return summary;
}

}  // namespace lodeline

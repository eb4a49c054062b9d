#pragma once

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/mapping/control/tags/tag_observer.h"
#include "lodeline/mapping/recognition/keyframe_describer.h"
#include "lodeline/mapping/session/dive_mapping.h"
#include "lodeline/mapping/session/keyframe_choice.h"
#include "lodeline/mapping/session/loops/loop_closures.h"
#include "lodeline/mapping/session/mapping_thread.h"
#include "lodeline/output/files/pose_writer.h"

namespace lodeline {

/// What a run tells its map beside its keyframes.
struct RunMappingRequest {
  std::filesystem::path folder;                      ///< for map.db, loops.csv and the poses in the map
  std::filesystem::path earlier_map;                 ///< a map to start from; empty for none
  std::string name;                                  ///< of the dive
  std::string recording;                             ///< as the user gave it
  HeadingReference north = HeadingReference::Start;  ///< that the headings of the keyframes count from
  KeyframeChoiceOptions keyframes;
  MappingOptions mapping;
  /// Tags on the line; none are looked for where no size is known.
  TagOptions tags;
};

/// The map of a dive while its run goes on: chooses and describes keyframes, finds loops on another thread,
/// and publishes the map-from-odometry transform beside the odometry, which never jumps.
class RunMapping {
 public:
  /// Throws InputError where a file cannot be written, or the earlier map cannot be read.
  RunMapping(const RunMappingRequest& request, const Rig& rig, Diagnostics* diagnostics);
  ~RunMapping();

  /// To be called after each packet. Returns whether the frame became a keyframe. `stamp`: of the result, for
  /// trajectory_map.tum; empty where it has none.
  bool add(const FramePacket& packet, const FrameEstimate& estimate, std::optional<Time> stamp,
           const PacketOdometry& odometry);

  /// Completes map.db, loops.csv and trajectory_map.tum; writes keyframes_map.tum, and control.csv where tags
  /// were seen.
  MappingSummary finish(const MagnetometerEstimate& last);

  /// What the batch solution needs, after finish(): accepted loops within the dive, and poses that close
  /// them.
  const LoopClosures& closures() const { return closures_; }
  /// Rotation about the vertical and translation from the odometry's world to the map's. Without an earlier
  /// map and before a loop, it is the rotation to the north that `newest` knows, or the identity. Empty while
  /// the place in an earlier map is unknown.
  std::optional<Rigid3> mapFromOdom(const FrameEstimate& newest) const;
  bool isPlaced() const { return is_placed_; }

 private:
  void take(const MappingStep& step);
  std::vector<SeenTag> tagsIn(const FramePacket& packet) const;
  void writeLedger() const;
  void writeKeyframes() const;
  /// Puts the stored solution into the frame of the stated positions of tags, where some of these were seen.
  void solveForStatedTags();
  void reportTags() const;

  RunMappingRequest request_;
  Diagnostics* diagnostics_;
  KeyframeChoice choice_;
  KeyframeDescriber describer_;
  std::deque<TagObserver> tag_observers_;  ///< one for each camera; empty where tags are not looked for
  std::optional<MapFile> earlier_;
  std::optional<MapFile> own_;
  std::unique_ptr<DiveMapping> mapping_;
  std::unique_ptr<MappingThread> thread_;  ///< after mapping_, which it uses
  PoseWriter trajectory_;
  Rigid3 map_from_odom_;
  bool is_placed_ = false;
  size_t rows_ = 0;                          ///< of trajectory_map.tum
  std::optional<size_t> rows_before_north_;  ///< written before a solution turned the map to north
  Time newest_;
  std::vector<VerifiedLoop> accepted_;
  LoopClosures closures_;
};

}  // namespace lodeline

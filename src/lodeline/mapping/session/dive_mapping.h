#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/graph/keyframe_factors.h"
#include "lodeline/mapping/graph/motion/level_motion.h"
#include "lodeline/mapping/recognition/descriptor_index.h"
#include "lodeline/mapping/session/dive_start.h"
#include "lodeline/mapping/session/loops/candidate_search.h"
#include "lodeline/mapping/session/loops/known_keyframes.h"
#include "lodeline/mapping/session/loops/loop_acceptance.h"
#include "lodeline/mapping/session/tags/dive_tags.h"
#include "lodeline/mapping/store/map_change.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

struct MappingOptions {
  CandidateSearchOptions candidates;
  LoopVerifierOptions verifier;
  PoseGraphOptions graph;
  KeyframeFactorOptions factors;
  /// Where the dive begins in an earlier map. With north it places the dive until places are recognized.
  std::optional<DiveStart> start;
  ControlSet tags;  ///< names and stated positions of tags; visits are not used
};

/// Result for one keyframe.
struct MappingStep {
  KeyframeId keyframe = -1;
  std::vector<VerifiedLoop> accepted;  ///< with this keyframe, or waiting ones that it confirms
  bool is_placed = false;              ///< whether the pose in the map is known
  bool has_north = false;              ///< whether a solution has turned the map to the magnetometer's north
  Rigid3 map_from_odom;                ///< rotation about the vertical and translation
};

/// Builds the map of one dive from its keyframes, in order: stores them, looks for loops within the dive and
/// with an earlier map, and solves the graph of poses where loops were accepted.
class DiveMapping {
 public:
  /// `own`: file of this dive's map. `dive`: its row, number left open. `earlier`: a map to start from; null
  /// for none. Both files must outlive this object.
  DiveMapping(MapFile* own, MapDive dive, const MapFile* earlier, const MappingOptions& options);

  /// Adds a keyframe; its id and dive are set here.
  MappingStep add(MapKeyframe keyframe);

  /// States the north that the dive has found at its end.
  void setHeadingReference(HeadingReference reference) { dive_.heading_reference = reference; }

  /// Completes the map: final solution with covariances, ledger. `end`: time of the dive's last frame.
  MappingSummary finish(Time end);

  /// All candidates so far with what became of them.
  const std::vector<Loop>& ledger() const { return ledger_; }
  const KnownKeyframes& known() const { return known_; }
  const MappingSummary& summary() const { return summary_; }
  const PoseGraph& graph() const { return graph_; }
  /// Number of this dive among the known keyframes.
  int dive() const { return dive_number_; }

 private:
  /// A verified loop that is not yet offered for acceptance.
  struct PendingLoop {
    VerifiedLoop verified;
    LoopEvidence evidence;
  };

  void loadEarlier();
  /// Places the dive in the earlier map by its first keyframe, if its start is stated.
  void place(const MapKeyframe& first);
  MapKeyframe full(KeyframeId id) const;
  void store(MapKeyframe* keyframe);
  void look(const MapKeyframe& keyframe, MappingStep* step);
  /// Offers pending loops for acceptance, except those that wait for the magnetic field of their new way.
  void decidePending(bool is_end, MappingStep* step);
  void use(std::vector<VerifiedLoop> decided, MappingStep* step);
  /// Counts what became of tags. Their ties wait for the next solution.
  void use(const TagStep& tags);
  /// Solves the graph; the ties of tags get their poses from it.
  GraphSummary solve();
  void joinGraph(KeyframeId earlier);
  DiveTags::Join joining();
  void updatePoses();
  /// Joins the way in and the way out by the shape of the passage.
  void registerClouds();
  /// Counts a loop that an aligning step has verified, and lets the magnetic field contradict it. Others are
  /// recorded.
  bool isVerified(Loop* loop);
  void record(const Loop& loop);
  /// Marks the loops that the solution refuses in the ledger, which has them in the same order.
  void recordRefused(const GraphSummary& solution);

  MapFile* own_;
  MapDive dive_;
  const MapFile* earlier_;
  MappingOptions options_;
  LoopVerifier verifier_;
  CandidateSearch search_;
  DescriptorIndex index_;
  KnownKeyframes known_;
  std::vector<PendingLoop> pending_;
  LoopAcceptance acceptance_;
  PoseGraph graph_;
  DiveTags tags_;
  std::vector<TagTie> new_ties_;  ///< since the last solution
  std::optional<MapChange> change_;
  int uncommitted_ = 0;
  int dive_number_ = 1;  ///< of this dive in memory, beyond those of the earlier map
  KeyframeId next_id_ = 1;
  double path_m_ = 0.0;
  std::optional<MapKeyframe> previous_;  ///< without features
  std::vector<MapKeyframe> recent_;      ///< the last seconds, with features
  Rigid3 map_from_odom_;
  bool has_north_ = false;
  bool is_placed_ = true;
  std::vector<Loop> ledger_;
  MappingSummary summary_;
};

}  // namespace lodeline

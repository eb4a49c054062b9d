#pragma once

#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/mapping/control/files/control_set.h"
#include "lodeline/mapping/graph/pose_graph.h"
#include "lodeline/mapping/session/tags/tag_places.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline {

/// Source of the rows of the ledger that come from tags.
constexpr const char* kTagSource = "tag";

/// Whether a row of the ledger says what the observations of control points say already. Such rows are not
/// stored as loops, or the solution would use them twice.
bool isTagTie(const Loop& loop);

/// Two keyframes that see one tag, far apart along the path or in two dives.
struct TagTie {
  Loop row;           ///< of the ledger, without the pose
  std::string place;  ///< name of the landmark
};

/// What the tags of one keyframe mean.
struct TagStep {
  std::vector<TagTie> ties;
  std::vector<Loop> refused;  ///< observations of a number that cannot be the tag seen before
};

/// The tags that a dive sees, as landmarks of its graph.
///
/// A number names a tag, but two tags may carry the same number. A observation therefore joins a place only
/// if the predicted pose relative to an earlier observation allows it. Otherwise it starts another place of
/// that number, which is reported. Between dives whose relative position is unknown, one number proves
/// nothing: two tags at the same distance from each other are needed.
class DiveTags {
 public:
  /// Makes sure that a keyframe of an earlier dive is in the graph; false where that is impossible.
  using Join = std::function<bool(KeyframeId)>;

  /// `control`: names and stated positions of tags.
  explicit DiveTags(const ControlSet& control);

  /// Takes the tags of an earlier map, whose keyframes are known.
  void load(const MapFile& earlier);
  /// `dive`: number of the dive among the known keyframes.
  void startDive(int dive) { dive_ = dive; }

  /// Adds the tags of a keyframe that is known and in the graph.
  TagStep add(const MapKeyframe& keyframe, const KnownKeyframes& known, PoseGraph* graph, const Join& join);
  /// Decides what is still open at the end of the dive.
  TagStep finish(const KnownKeyframes& known, PoseGraph* graph, const Join& join);

  /// Writes the tags of the dive as control points and observations.
  void write(const KnownKeyframes& known, MapChange* change) const;

  const std::vector<TagPlace>& places() const { return places_; }

 private:
  /// What an addition works on.
  struct Work {
    const KnownKeyframes& known;
    PoseGraph* graph;
    const Join& join;
    TagStep* step;
  };

  void place(int tag, const TagSeenAt& seen, const Work& work);
  void startPlace(int tag, const TagSeenAt& seen, const Work& work);
  void joinPlace(size_t place, const TagSeenAt& seen, const TagSeenAt* reference, double chi_squared,
                 const Work& work);
  const TagSeenAt* referenceOf(const TagPlace& place, KeyframeId newest, const KnownKeyframes& known) const;
  void addObservation(size_t place, const TagSeenAt& seen, const Work& work);
  void decideHeld(const Work& work);
  void decideByPrediction(const Work& work);
  void decideBySpacing(const Work& work);
  /// Says that a place of this dive is one of an earlier dive.
  void unite(const HeldTag& held, double chi_squared, const Work& work);
  std::string newName(int tag);

  ControlSet control_;
  int dive_ = -1;
  std::set<std::string> names_;
  std::vector<TagPlace> places_;
  std::vector<HeldTag> held_;
  std::set<size_t> landmarks_;                        ///< places in the graph
  std::set<std::pair<size_t, KeyframeId>> in_graph_;  ///< observations in the graph
};

}  // namespace lodeline

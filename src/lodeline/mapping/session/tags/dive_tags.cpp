#include "lodeline/mapping/session/tags/dive_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lodeline/mapping/control/control_residual.h"

namespace lodeline {
namespace {

/// Path between two observations from which on they tie the graph together and are reported, m.
constexpr double kLeastTiePath_m = 8.0;

Loop rowOf(KeyframeId old_keyframe, KeyframeId new_keyframe, double chi_squared) {
  Loop row;
  row.old_keyframe = old_keyframe;
  row.new_keyframe = new_keyframe;
  row.source = kTagSource;
  row.matches = 1;
  row.mahalanobis_squared = chi_squared;
  return row;
}

TagTie tieOf(KeyframeId old_keyframe, KeyframeId new_keyframe, double chi_squared, const std::string& place) {
  TagTie tie{rowOf(old_keyframe, new_keyframe, chi_squared), place};
  tie.row.status = LoopStatus::Accepted;
  tie.row.inliers = 1;
  return tie;
}

Loop refusalOf(KeyframeId old_keyframe, KeyframeId new_keyframe, double chi_squared, std::string reason) {
  Loop refusal = rowOf(old_keyframe, new_keyframe, chi_squared);
  refusal.status = LoopStatus::Refused;
  refusal.reason = std::move(reason);
  return refusal;
}

std::string contradictionText(int tag, const TagAgreement& agreement) {
  return fmt::format(
      "tag {} hangs {:.2f} m from where it was seen before (chi^2 {:.1f}, at most {:.1f} with 3 degrees of "
      "freedom): two tags have this number, or one was moved",
      tag, agreement.distance_m, agreement.chi_squared, kControlQuantile);
}

}  // namespace

bool isTagTie(const Loop& loop) { return loop.source == kTagSource && loop.status == LoopStatus::Accepted; }

DiveTags::DiveTags(const ControlSet& control) : control_(control) {
  for (const ControlPoint& point : control_.points) {
    names_.insert(point.name);
    if (point.tag) places_.push_back({*point.tag, point.name, {}});
  }
}

void DiveTags::load(const MapFile& earlier) {
  std::map<int64_t, size_t> place_of;
  for (const ControlPoint& point : earlier.controlPoints()) {
    names_.insert(point.name);
    if (!point.tag) continue;
    const auto stated = std::find_if(places_.begin(), places_.end(), [&](const TagPlace& place) {
      return place.tag == *point.tag && control_.find(place.name) != nullptr;
    });
    if (stated != places_.end()) {
      // The map's name for it stays.
      for (ControlPoint& named : control_.points) {
        if (named.name == stated->name) named.name = point.name;
      }
      stated->name = point.name;
    }
    place_of[point.id] = static_cast<size_t>(stated - places_.begin());
    if (stated == places_.end()) places_.push_back({*point.tag, point.name, {}});
  }
  for (const ControlObservation& seen : earlier.controlObservations()) {
    const auto place = place_of.find(seen.point);
    if (place == place_of.end()) continue;
    places_[place->second].observations.push_back(
        {seen.keyframe, seen.in_body.position, seen.in_body.covariance});
  }
}

std::string DiveTags::newName(int tag) {
  std::string name = fmt::format("tag {}", tag);
  for (int i = 2; !names_.insert(name).second; ++i) name = fmt::format("tag {} ({})", tag, i);
  return name;
}

TagStep DiveTags::add(const MapKeyframe& keyframe, const KnownKeyframes& known, PoseGraph* graph,
                      const Join& join) {
  TagStep step;
  const Work work{known, graph, join, &step};
  for (const SeenTag& seen : keyframe.tags)
    place(seen.tag, {keyframe.id, seen.centre_B, seen.covariance}, work);
  if (!keyframe.tags.empty()) decideHeld(work);
  return step;
}

const TagSeenAt* DiveTags::referenceOf(const TagPlace& place, KeyframeId newest,
                                       const KnownKeyframes& known) const {
  const TagSeenAt* reference = nullptr;
  for (auto seen = place.observations.rbegin(); seen != place.observations.rend(); ++seen) {
    if (known.at(seen->keyframe).dive == dive_) return &*seen;
    if (!reference && known.predict(seen->keyframe, newest)) reference = &*seen;
  }
  return reference;
}

void DiveTags::place(int tag, const TagSeenAt& seen, const Work& work) {
  std::optional<size_t> best, unseen;
  std::vector<size_t> unpredicted;
  TagAgreement best_agreement, nearest_refused;
  std::optional<KeyframeId> refused_by;
  for (size_t i = 0; i < places_.size(); ++i) {
    if (places_[i].tag != tag) continue;
    if (places_[i].observations.empty()) {
      unseen = i;
      continue;
    }
    const TagSeenAt* reference = referenceOf(places_[i], seen.keyframe, work.known);
    if (!reference) {
      unpredicted.push_back(i);
      continue;
    }
    const TagAgreement agreement =
        agreementOf(*reference, seen, *work.known.predict(reference->keyframe, seen.keyframe));
    if (agreement.holds()) {
      if (!best || agreement.chi_squared < best_agreement.chi_squared) {
        best = i;
        best_agreement = agreement;
      }
    } else if (!refused_by || agreement.distance_m < nearest_refused.distance_m) {
      refused_by = reference->keyframe;
      nearest_refused = agreement;
    }
  }
  if (best) {
    joinPlace(*best, seen, referenceOf(places_[*best], seen.keyframe, work.known), best_agreement.chi_squared,
              work);
    return;
  }
  if (unseen && !refused_by) {
    joinPlace(*unseen, seen, nullptr, 0.0, work);
    return;
  }
  if (refused_by) {
    work.step->refused.push_back(refusalOf(*refused_by, seen.keyframe, nearest_refused.chi_squared,
                                           contradictionText(tag, nearest_refused)));
  }
  startPlace(tag, seen, work);
  for (const size_t earlier : unpredicted) held_.push_back({places_.size() - 1, earlier});
}

void DiveTags::startPlace(int tag, const TagSeenAt& seen, const Work& work) {
  places_.push_back({tag, newName(tag), {}});
  joinPlace(places_.size() - 1, seen, nullptr, 0.0, work);
}

void DiveTags::joinPlace(size_t place, const TagSeenAt& seen, const TagSeenAt* reference, double chi_squared,
                         const Work& work) {
  if (reference) {
    const KnownKeyframe &before = work.known.at(reference->keyframe), &now = work.known.at(seen.keyframe);
    const bool is_other_dive = before.dive != dive_;
    if (is_other_dive && work.join(reference->keyframe)) addObservation(place, *reference, work);
    if (is_other_dive || now.path_m - before.path_m >= kLeastTiePath_m)
      work.step->ties.push_back(tieOf(reference->keyframe, seen.keyframe, chi_squared, places_[place].name));
  }
  addObservation(place, seen, work);
  places_[place].observations.push_back(seen);
}

void DiveTags::addObservation(size_t place, const TagSeenAt& seen, const Work& work) {
  const std::string& name = places_[place].name;
  if (landmarks_.insert(place).second) work.graph->add(GraphLandmark{name, std::nullopt, Mat3::Identity()});
  if (!in_graph_.insert({place, seen.keyframe}).second) return;
  LandmarkObservation observation;
  observation.landmark = name;
  observation.node = seen.keyframe;
  observation.point_B = seen.centre_B;
  observation.covariance = seen.covariance;
  work.graph->add(observation);
}

void DiveTags::decideHeld(const Work& work) {
  decideByPrediction(work);
  decideBySpacing(work);
}

void DiveTags::decideByPrediction(const Work& work) {
  std::vector<HeldTag> open, agreeing;
  std::vector<double> chi_squared;
  for (const HeldTag& held : held_) {
    const TagPlace &own = places_[held.own_place], &earlier = places_[held.earlier_place];
    const TagSeenAt &newest = own.observations.back(), &before = earlier.observations.back();
    const auto prediction = work.known.predict(before.keyframe, newest.keyframe);
    if (!prediction) {
      open.push_back(held);
      continue;
    }
    const TagAgreement agreement = agreementOf(before, newest, *prediction);
    if (agreement.holds()) {
      agreeing.push_back(held);
      chi_squared.push_back(agreement.chi_squared);
    } else {
      work.step->refused.push_back(refusalOf(before.keyframe, newest.keyframe, agreement.chi_squared,
                                             contradictionText(own.tag, agreement)));
    }
  }
  held_ = std::move(open);
  for (size_t i = 0; i < agreeing.size(); ++i) unite(agreeing[i], chi_squared[i], work);
}

void DiveTags::decideBySpacing(const Work& work) {
  std::set<size_t> confirmed;
  for (size_t i = 0; i < held_.size(); ++i) {
    for (size_t j = i + 1; j < held_.size(); ++j) {
      const TagPlace &own_1 = places_[held_[i].own_place], &own_2 = places_[held_[j].own_place];
      const TagPlace &earlier_1 = places_[held_[i].earlier_place],
                     &earlier_2 = places_[held_[j].earlier_place];
      if (own_1.tag == own_2.tag || !haveSameSpacing(own_1, own_2, earlier_1, earlier_2, work.known))
        continue;
      confirmed.insert({i, j});
    }
  }
  std::vector<HeldTag> open, agreeing;
  for (size_t i = 0; i < held_.size(); ++i) (confirmed.count(i) > 0 ? agreeing : open).push_back(held_[i]);
  held_ = std::move(open);
  for (const HeldTag& held : agreeing) unite(held, 0.0, work);
}

void DiveTags::unite(const HeldTag& held, double chi_squared, const Work& work) {
  TagPlace &own = places_[held.own_place], &earlier = places_[held.earlier_place];
  if (own.observations.empty()) return;  // united with another place already
  const TagSeenAt before = earlier.observations.back(), newest = own.observations.back();
  if (!work.join(before.keyframe)) return;
  addObservation(held.earlier_place, before, work);
  addObservation(held.earlier_place, newest, work);
  work.step->ties.push_back(tieOf(before.keyframe, newest.keyframe, chi_squared, earlier.name));
  earlier.observations.insert(earlier.observations.end(), own.observations.begin(), own.observations.end());
  own.observations.clear();
  own.tag = -1;  // no place any more
  std::erase_if(held_, [&](const HeldTag& other) { return other.own_place == held.own_place; });
}

TagStep DiveTags::finish(const KnownKeyframes& known, PoseGraph* graph, const Join& join) {
  TagStep step;
  const Work work{known, graph, join, &step};
  decideHeld(work);
  for (const HeldTag& held : held_) {
    const TagPlace& own = places_[held.own_place];
    step.refused.push_back(refusalOf(
        places_[held.earlier_place].observations.back().keyframe, own.observations.back().keyframe, 0.0,
        fmt::format("neither a second tag nor a recognized place confirms that tag {} is the one "
                    "of the earlier dive",
                    own.tag)));
  }
  held_.clear();
  return step;
}

void DiveTags::write(const KnownKeyframes& known, MapChange* change) const {
  for (const TagPlace& place : places_) {
    if (place.tag < 0) continue;
    ControlPoint point;
    if (const ControlPoint* stated = control_.find(place.name)) point = *stated;
    const auto is_own = [&](const TagSeenAt& seen) { return known.at(seen.keyframe).dive == dive_; };
    const bool is_seen = std::any_of(place.observations.begin(), place.observations.end(), is_own);
    if (!is_seen && !point.position) continue;
    point.name = place.name;
    point.kind = ControlKind::Tag;
    point.tag = place.tag;
    if (point.origin.empty()) point.origin = "images";
    const int64_t id = change->putControlPoint(point);
    for (const TagSeenAt& seen : place.observations) {
      if (is_own(seen)) change->addControlObservation({id, seen.keyframe, {seen.centre_B, seen.covariance}});
    }
  }
}

}  // namespace lodeline

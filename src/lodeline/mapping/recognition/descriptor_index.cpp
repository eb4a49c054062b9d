#include "lodeline/mapping/recognition/descriptor_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/util/settings/option_check.h"

namespace lodeline {
namespace {

/// Entries of a leaf at which it splits, a power of two.
constexpr size_t kLeafSize = 64;

bool bitOf(const Descriptor& descriptor, int bit) {
  return (descriptor.bits[static_cast<size_t>(bit / 64)] >> (bit % 64)) & 1U;
}

}  // namespace

void DescriptorIndexOptions::check() const {
  OptionCheck("descriptor_index")
      .atLeast("features_per_keyframe", features_per_keyframe, 1)
      .within("max_distance", max_distance, 0, kDescriptorBits / 2.0);
}

DescriptorIndex::DescriptorIndex(const DescriptorIndexOptions& options) : options_(options), nodes_(1) {
  options.check();
}

std::vector<int> DescriptorIndex::indexedFeatures(const MapKeyframe& keyframe) const {
  std::vector<int> features;
  const auto most = static_cast<size_t>(options_.features_per_keyframe);
  for (const bool has_point : {true, false}) {
    for (size_t i = 0; i < keyframe.features.size() && features.size() < most; ++i)
      if (keyframe.features[i].point_B.has_value() == has_point) features.push_back(static_cast<int>(i));
  }
  return features;
}

void DescriptorIndex::add(const MapKeyframe& keyframe) {
  if (keyframe.id < 0) throw InputError(fmt::format("keyframe {}: its id is negative", keyframe.id));
  for (const Indexed& indexed : keyframes_) {
    if (indexed.id == keyframe.id && !indexed.is_removed)
      throw InputError(fmt::format("keyframe {} is in the index already", keyframe.id));
  }
  const auto number = static_cast<uint32_t>(keyframes_.size());
  keyframes_.push_back({keyframe.id, keyframe.dive, false});
  for (const int i : indexedFeatures(keyframe))
    insert({keyframe.features[static_cast<size_t>(i)].descriptor, number});
}

void DescriptorIndex::removeDive(int dive) {
  for (Indexed& indexed : keyframes_) {
    if (indexed.dive != dive || indexed.is_removed) continue;
    indexed.is_removed = true;
    ++removed_;
  }
  for (Node& node : nodes_) {
    std::erase_if(node.entries, [&](const Entry& entry) { return keyframes_[entry.keyframe].is_removed; });
  }
}

uint32_t DescriptorIndex::leafOf(const Descriptor& descriptor, uint32_t from) const {
  while (nodes_[from].bit >= 0) from = nodes_[from].children[bitOf(descriptor, nodes_[from].bit) ? 1 : 0];
  return from;
}

void DescriptorIndex::insert(const Entry& entry) {
  const uint32_t leaf = leafOf(entry.descriptor, 0);
  std::vector<Entry>& entries = nodes_[leaf].entries;
  entries.push_back(entry);
  // A leaf of look-alikes that cannot be divided is tried again when it has doubled.
  const size_t size = entries.size();
  if (size >= kLeafSize && (size & (size - 1)) == 0) split(leaf);
}

void DescriptorIndex::split(uint32_t leaf) {
  constexpr size_t kLeastShare = 8;  // the smaller part has at least an eighth: depth stays logarithmic
  std::array<size_t, kDescriptorBits> ones{};
  const size_t size = nodes_[leaf].entries.size();
  for (const Entry& entry : nodes_[leaf].entries) {
    for (int bit = 0; bit < kDescriptorBits; ++bit)
      ones[static_cast<size_t>(bit)] += bitOf(entry.descriptor, bit) ? 1 : 0;
  }
  const auto smaller = [&](size_t count) { return std::min(count, size - count); };
  const auto best =
      std::max_element(ones.begin(), ones.end(), [&](size_t a, size_t b) { return smaller(a) < smaller(b); });
  if (smaller(*best) * kLeastShare < size) return;

  const auto children = static_cast<uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  Node& node = nodes_[leaf];
  node.bit = static_cast<int16_t>(best - ones.begin());
  node.children[0] = children;
  node.children[1] = children + 1;
  const std::vector<Entry> entries = std::move(node.entries);
  node.entries = {};
  for (const Entry& entry : entries)
    nodes_[children + (bitOf(entry.descriptor, node.bit) ? 1 : 0)].entries.push_back(entry);
}

void DescriptorIndex::leavesOf(const Descriptor& descriptor, std::vector<uint32_t>* leaves) const {
  leaves->clear();
  uint32_t at = 0;
  while (nodes_[at].bit >= 0) {
    const int side = bitOf(descriptor, nodes_[at].bit) ? 1 : 0;
    leaves->push_back(leafOf(descriptor, nodes_[at].children[1 - side]));
    at = nodes_[at].children[side];
  }
  leaves->push_back(at);
}

std::vector<SimilarKeyframe> DescriptorIndex::query(const MapKeyframe& keyframe, int most,
                                                    const std::function<bool(KeyframeId)>& excluded) const {
  std::vector<char> is_out(keyframes_.size());
  for (size_t k = 0; k < keyframes_.size(); ++k)
    is_out[k] = keyframes_[k].is_removed || (excluded && excluded(keyframes_[k].id));
  std::vector<SimilarKeyframe> found(keyframes_.size());
  std::vector<uint32_t> leaves, hits;
  for (const MapFeature& feature : keyframe.features) {
    leavesOf(feature.descriptor, &leaves);
    hits.clear();
    for (const uint32_t leaf : leaves) {
      for (const Entry& entry : nodes_[leaf].entries) {
        if (!is_out[entry.keyframe] &&
            distanceOf(entry.descriptor, feature.descriptor) <= options_.max_distance)
          hits.push_back(entry.keyframe);
      }
    }
    std::sort(hits.begin(), hits.end());
    hits.erase(std::unique(hits.begin(), hits.end()), hits.end());
    const double weight = std::log1p(static_cast<double>(size()) / static_cast<double>(hits.size() + 1));
    for (const uint32_t hit : hits) {
      ++found[hit].votes;
      found[hit].score += weight;
    }
  }
  for (size_t k = 0; k < found.size(); ++k) found[k].id = keyframes_[k].id;
  std::erase_if(found, [](const SimilarKeyframe& similar) { return similar.votes == 0; });
  std::sort(found.begin(), found.end(), [](const SimilarKeyframe& a, const SimilarKeyframe& b) {
    return a.score != b.score ? a.score > b.score : a.id < b.id;
  });
  if (found.size() > static_cast<size_t>(std::max(0, most)))
    found.resize(static_cast<size_t>(std::max(0, most)));
  return found;
}

}  // namespace lodeline

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

struct DescriptorIndexOptions {
  /// Features of a keyframe that are indexed: those with a position first.
  int features_per_keyframe = 200;
  /// Largest number of bits in which a descriptor and a similar one differ.
  int max_distance = 50;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// A keyframe that resembles another one.
struct SimilarKeyframe {
  KeyframeId id = -1;
  int votes = 0;       ///< features of the query with a similar feature in it
  double score = 0.0;  ///< sum of the votes' weights: the logarithm of how rare each one is
};

/// Finds keyframes with similar descriptors, without a vocabulary.
///
/// Descriptors are in a binary search tree. Each node tests one bit, each leaf holds up to 64 descriptors. A
/// full leaf splits at the bit that divides it best (D. Schlegel and G. Grisetti, "HBST: a Hamming distance
/// embedding binary search tree for feature-based visual place recognition", RA-L 2018). A search visits the
/// leaf of the query and the leaves that differ from its path in one decision: descriptors differ in some
/// bits. Adding and searching take time logarithmic in the number of descriptors.
///
/// Memory: about 55 bytes for each indexed feature: 110 MB for 10^4 keyframes of 200 features.
class DescriptorIndex {
 public:
  explicit DescriptorIndex(const DescriptorIndexOptions& options = {});

  /// Adds a keyframe. Throws InputError where its id is negative or present.
  void add(const MapKeyframe& keyframe);
  /// Removes all keyframes of a dive.
  void removeDive(int dive);
  size_t size() const { return keyframes_.size() - removed_; }

  /// The `most` best keyframes, highest score first and lowest id among equals. Keyframes that `excluded`
  /// names have no part.
  std::vector<SimilarKeyframe> query(const MapKeyframe& keyframe, int most,
                                     const std::function<bool(KeyframeId)>& excluded = {}) const;

 private:
  struct Entry {
    Descriptor descriptor;
    uint32_t keyframe = 0;  ///< index into keyframes_
  };
  struct Node {
    int16_t bit = -1;  ///< tested by an inner node; -1: a leaf
    uint32_t children[2] = {0, 0};
    std::vector<Entry> entries;  ///< of a leaf
  };
  struct Indexed {
    KeyframeId id = -1;
    int dive = 0;
    bool is_removed = false;
  };

  std::vector<int> indexedFeatures(const MapKeyframe& keyframe) const;
  uint32_t leafOf(const Descriptor& descriptor, uint32_t from) const;
  void insert(const Entry& entry);
  void split(uint32_t leaf);
  /// Leaves that a search visits.
  void leavesOf(const Descriptor& descriptor, std::vector<uint32_t>* leaves) const;

  DescriptorIndexOptions options_;
  std::vector<Node> nodes_;
  std::vector<Indexed> keyframes_;
  size_t removed_ = 0;
};

}  // namespace lodeline

// Measures which share of true revisits between two simulated dives of one cave is recognized, stage by
// stage. Prints the table of docs/lab-notes/slam.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <regex>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/recognition/descriptor_index.h"
#include "lodeline/mapping/recognition/loop_verifier.h"
#include "lodeline/mapping/recognition/merge_keyframes.h"
#include "lodeline/mapping/recognition/verification/descriptor_matcher.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/thread_clock.h"
#include "studies/mapping/described_dive.h"

namespace {

using namespace lodeline;

constexpr double kNear_m = 1.0, kNear_rad = 20.0 * kDegree;
constexpr int kCandidates = 8;

/// Counts of all stages over the revisits of one pair of dives.
struct Stages {
  int keyframes = 0, revisits = 0;
  double features = 0, points = 0;
  int in_view = 0, repeated = 0, within_bits = 0, matched = 0;
  std::vector<double> bits;
  int first = 0, among_3 = 0, among_8 = 0;
  int nearest_verified = 0, candidate_verified = 0, clip_verified = 0, local_verified = 0;
  int wrong = 0, impossible = 0, impossible_accepted = 0;
  double nees = 0, error_m = 0, error_deg = 0;
  int errors = 0;
  double verifying_s = 0;
  int verifications = 0;
  std::map<std::string, int> reasons;
};

class Study {
 public:
  Study(const DescribedDive& old_dive, const DescribedDive& new_dive) : old_(old_dive), new_(new_dive) {
    for (const MapKeyframe& keyframe : old_.keyframes) index_.add(keyframe);
  }

  Stages run() {
    for (size_t i = 0; i < new_.keyframes.size(); ++i) examine(i);
    return stages_;
  }

 private:
  Rigid3 trueOldFromNew(size_t o, size_t n) const {
    return old_.cave_from_bodies[o].inverse() * new_.cave_from_bodies[n];
  }
  bool isRevisit(size_t o, size_t n) const {
    const Rigid3 pose = trueOldFromNew(o, n);
    return pose.translation.norm() <= kNear_m && pose.rotation.angularDistance(Quat::Identity()) <= kNear_rad;
  }
  bool isElsewhere(size_t o, size_t n) const { return trueOldFromNew(o, n).translation.norm() > 6.0; }

  void examine(size_t n) {
    ++stages_.keyframes;
    std::vector<size_t> true_ones;
    for (size_t o = 0; o < old_.keyframes.size(); ++o)
      if (isRevisit(o, n)) true_ones.push_back(o);
    // Every fifth pair of different places.
    for (size_t o = n % 5; o < old_.keyframes.size(); o += 5) {
      if (!isElsewhere(o, n)) continue;
      ++stages_.impossible;
      stages_.impossible_accepted += verify(o, new_.keyframes[n]).status == LoopStatus::Verified ? 1 : 0;
    }
    if (true_ones.empty()) return;
    ++stages_.revisits;
    const size_t nearest = *std::min_element(true_ones.begin(), true_ones.end(), [&](size_t a, size_t b) {
      return trueOldFromNew(a, n).translation.norm() < trueOldFromNew(b, n).translation.norm();
    });
    countFeatures(nearest, n);
    const auto similar = index_.query(new_.keyframes[n], kCandidates);
    size_t rank = 0;
    while (rank < similar.size() && !isRevisit(static_cast<size_t>(similar[rank].id), n)) ++rank;
    stages_.first += rank < std::min<size_t>(1, similar.size()) ? 1 : 0;
    stages_.among_3 += rank < std::min<size_t>(3, similar.size()) ? 1 : 0;
    stages_.among_8 += rank < similar.size() ? 1 : 0;
    const Loop loop = verify(nearest, new_.keyframes[n]);
    if (loop.status == LoopStatus::Verified) {
      ++stages_.nearest_verified;
    } else {
      ++stages_.reasons[std::regex_replace(loop.reason, std::regex("-?[0-9]+(\\.[0-9]+)?"), "#")];
      fmt::print("  {}\n", loop.reason);
    }
    stages_.candidate_verified += isFound(n, new_.keyframes[n], similar, true) ? 1 : 0;
    // A clip is found where one of its keyframes is.
    const size_t first = n >= 2 ? n - 2 : 0;
    const MapKeyframe clip = mergeKeyframes(std::span(new_.keyframes).subspan(first, n - first + 1));
    const auto like_clip = index_.query(clip, kCandidates);
    stages_.clip_verified += isFound(n, clip, like_clip, false) ? 1 : 0;
    stages_.local_verified += isFound(n, new_.keyframes[n], similar, false, 1) ? 1 : 0;
  }

  Loop verify(size_t o, const MapKeyframe& keyframe) {
    const double start_s = threadSeconds();
    const Loop loop = LoopVerifier().verify(old_.keyframes[o], keyframe);
    stages_.verifying_s += threadSeconds() - start_s;
    ++stages_.verifications;
    return loop;
  }

  bool isFound(size_t n, const MapKeyframe& keyframe, const std::vector<SimilarKeyframe>& similar,
               bool with_errors, size_t neighbours = 0) {
    bool found = false;
    for (const SimilarKeyframe& candidate : similar) {
      const auto o = static_cast<size_t>(candidate.id);
      const Loop loop =
          neighbours == 0 ? verify(o, keyframe) : LoopVerifier().verify(localMap(o, neighbours), keyframe);
      if (loop.status != LoopStatus::Verified) continue;
      found = true;
      const Rigid3 truth = trueOldFromNew(o, n);
      Eigen::Matrix<double, 6, 1> error;
      error << truth.translation - loop.old_from_new.translation,
          so3::log(truth.rotation * loop.old_from_new.rotation.conjugate());
      if (error.head<3>().norm() > 0.3 || error.tail<3>().norm() > 5.0 * kDegree) {
        ++stages_.wrong;
        fmt::print(
            "  wrong by {:.2f} m {:.1f} deg, claimed {:.2f} m, squared {:.1f}, {} inliers cover {:.2f}\n",
            error.head<3>().norm(), error.tail<3>().norm() / kDegree,
            std::sqrt(loop.covariance.topLeftCorner<3, 3>().trace()),
            error.dot(loop.covariance.ldlt().solve(error)), loop.inliers, loop.covered_share);
      }
      if (!with_errors) continue;
      ++stages_.errors;
      stages_.nees += error.dot(loop.covariance.ldlt().solve(error));
      stages_.error_m += error.head<3>().norm();
      stages_.error_deg += error.tail<3>().norm() / kDegree;
    }
    return found;
  }

  /// An old keyframe with the features of its neighbours on either side.
  MapKeyframe localMap(size_t o, size_t neighbours) const {
    const size_t first = o - std::min(o, neighbours);
    const size_t last = std::min(o + neighbours, old_.keyframes.size() - 1);
    return mergeKeyframes(std::span(old_.keyframes).subspan(first, last - first + 1), o - first);
  }

  /// Repetition of the points of the old keyframe that the truth places in the new image.
  void countFeatures(size_t o, size_t n) {
    constexpr double kSame_px = 2.0;
    constexpr int kMostBits = 68;
    const MapKeyframe &old_keyframe = old_.keyframes[o], &new_keyframe = new_.keyframes[n];
    stages_.features += static_cast<double>(new_keyframe.features.size());
    const auto matches = matchDescriptors(old_keyframe, new_keyframe, std::nullopt);
    std::map<int, int> matched;
    for (const DescriptorMatch& match : matches)
      matched[match.features.old_feature] = match.features.new_feature;
    const Rigid3 camera_from_old =
        (trueOldFromNew(o, n) * new_.camera->calibration().body_from_camera).inverse();
    for (size_t f = 0; f < old_keyframe.features.size(); ++f) {
      const MapFeature& feature = old_keyframe.features[f];
      if (!feature.point_B) continue;
      stages_.points += 1.0;
      const Vec3 point_C = camera_from_old * *feature.point_B;
      const auto pixel = new_.camera->project(point_C);
      if (point_C.z() <= 0.0 || !pixel || !new_.camera->contains(*pixel, 20.0)) continue;
      ++stages_.in_view;
      int same = -1;
      double least_px = kSame_px;
      for (size_t g = 0; g < new_keyframe.features.size(); ++g) {
        const double apart_px = (new_keyframe.features[g].rays[0].pixel - *pixel).norm();
        if (apart_px > least_px) continue;
        least_px = apart_px;
        same = static_cast<int>(g);
      }
      if (same < 0) continue;
      ++stages_.repeated;
      const int bits =
          distanceOf(feature.descriptor, new_keyframe.features[static_cast<size_t>(same)].descriptor);
      stages_.bits.push_back(bits);
      stages_.within_bits += bits <= kMostBits ? 1 : 0;
      const auto match = matched.find(static_cast<int>(f));
      stages_.matched += match != matched.end() && match->second == same ? 1 : 0;
    }
  }

  const DescribedDive &old_, &new_;
  DescriptorIndex index_;
  Stages stages_;
};

void print(const DescribedDive& dive, const char* name) {
  fmt::print("{}: {} frames, {} keyframes over {:.1f} m; {:.1f} ms to describe one, {:.2f} ms a frame\n",
             name, dive.frames, dive.keyframes.size(), dive.path_m,
             1e3 * dive.describing_s / static_cast<double>(dive.keyframes.size()),
             1e3 * dive.describing_s / dive.frames);
}

void print(Stages s) {
  const double n = std::max(1, s.revisits);
  fmt::print("revisits                 {} of {} keyframes\n", s.revisits, s.keyframes);
  fmt::print("features                 {:.0f}, old with a position {:.0f}\n", s.features / n, s.points / n);
  fmt::print("in view                  {:.0f}\n", s.in_view / n);
  fmt::print("repeated within 2 px     {:.1f} ({:.0f} %)\n", s.repeated / n, 100.0 * s.repeated / s.in_view);
  std::sort(s.bits.begin(), s.bits.end());
  if (!s.bits.empty()) {
    fmt::print("bits that differ         {} {} {} (quartiles)\n", s.bits[s.bits.size() / 4],
               s.bits[s.bits.size() / 2], s.bits[3 * s.bits.size() / 4]);
  }
  fmt::print("within 68 bits           {:.1f}\n", s.within_bits / n);
  fmt::print("matched                  {:.1f}\n", s.matched / n);
  const auto share = [&](const char* what, int count) {
    fmt::print("{:<25}{} ({:.0f} %)\n", what, count, 100.0 * count / n);
  };
  share("first in the index", s.first);
  share("among the first 3", s.among_3);
  share("among the first 8", s.among_8);
  share("nearest verified", s.nearest_verified);
  share("candidate verified", s.candidate_verified);
  share("clip verified", s.clip_verified);
  share("in local map", s.local_verified);
  fmt::print("wrong poses              {}\n", s.wrong);
  fmt::print("pairs of other places    {}, accepted {}\n", s.impossible, s.impossible_accepted);
  const double e = std::max(1, s.errors);
  fmt::print("errors                   {:.3f} m, {:.2f} deg, NEES {:.1f} of 6\n", s.error_m / e,
             s.error_deg / e, s.nees / e);
  fmt::print("a verification           {:.2f} ms\n", 1e3 * s.verifying_s / std::max(1, s.verifications));
  for (const auto& [reason, count] : s.reasons) fmt::print("  {} x {}\n", count, reason);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Share of true revisits that are recognized, stage by stage");
  std::string old_folder;
  std::vector<std::string> new_folders;
  app.add_option("OLD", old_folder, "recording of `lodeline simulate` with --cave-seed")->required();
  app.add_option("NEW", new_folders, "recordings of the same cave")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    const DescribedDive old_dive(old_folder);
    print(old_dive, old_folder.c_str());
    for (const std::string& folder : new_folders) {
      const DescribedDive new_dive(folder);
      print(new_dive, folder.c_str());
      print(Study(old_dive, new_dive).run());
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
  return 0;
}

#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "lodeline/base/diagnostics.h"
#include "lodeline/base/time.h"

namespace lodeline {

/// What a stream of one sensor is expected to look like.
struct StreamExpectation {
  std::string kind;  ///< prefix of the findings, e.g. "imu" for "imu_gap"
  std::string name;  ///< for messages, e.g. "cam1"
  double rate_hz = 0.0;
  double max_gap_s = 0.0;        ///< longer silence is reported
  Duration offset_to_imu_clock;  ///< added to every stamp
};

/// Judges the stamps of one stream.
class StampMonitor {
 public:
  StampMonitor(StreamExpectation expectation, Diagnostics* diagnostics)
      : expectation_(std::move(expectation)), diagnostics_(diagnostics) {}

  enum class Verdict { InOrder, DropCandidate, DropFollowing };

  /// Whether `candidate`, which is later than everything accepted, may stand before `following`, its
  /// successor in the recording. Where the two disagree the following one goes, except when the candidate
  /// leapt ahead by more than a second and its successor did not: one wild stamp must not silence the rest.
  Verdict judge(Time candidate, Time following);

  /// Notes the stamp as passed on; reports a gap before it.
  void accept(Time time);

  const StreamExpectation& expectation() const { return expectation_; }

 private:
  StreamExpectation expectation_;
  Diagnostics* diagnostics_;
  std::optional<Time> last_;
};

/// One sensor's readings with strictly increasing stamps on the IMU's clock; disorder, duplicates and gaps
/// are reported with their stamps, and what is out of order is dropped. Holds two readings at most.
template <typename Reading>
class OrderedStream {
 public:
  using Pull = std::function<std::optional<Reading>()>;

  OrderedStream(StreamExpectation expectation, Pull pull, Diagnostics* diagnostics)
      : pull_(std::move(pull)), monitor_(std::move(expectation), diagnostics) {}

  /// The next reading, left in the stream; null at the end.
  const Reading* peek() {
    if (!head_) advance();
    return head_ ? &*head_ : nullptr;
  }

  /// The reading after the one that peek() shows, as far as it is known; null at the end.
  const Reading* following() const { return following_ ? &*following_ : nullptr; }

  /// Moves all stamps that were not taken out yet.
  void shift(Duration by) {
    offset_ = offset_ + by;
    if (head_) head_->time = head_->time + by;
    if (following_) following_->time = following_->time + by;
  }

  /// Takes the next reading out; only after peek() has shown that there is one.
  Reading pop() {
    Reading reading = std::move(*head_);
    head_.reset();
    return reading;
  }

 private:
  std::optional<Reading> pull() {
    std::optional<Reading> reading = pull_();
    if (reading) reading->time = reading->time + monitor_.expectation().offset_to_imu_clock + offset_;
    return reading;
  }

  void advance() {
    std::optional<Reading> candidate = following_ ? std::exchange(following_, std::nullopt) : pull();
    while (candidate) {
      std::optional<Reading> following = pull();
      if (!following) break;
      const auto verdict = monitor_.judge(candidate->time, following->time);
      if (verdict == StampMonitor::Verdict::DropFollowing) continue;
      if (verdict == StampMonitor::Verdict::DropCandidate) {
        candidate = std::move(following);
        continue;
      }
      following_ = std::move(following);
      break;
    }
    if (candidate) monitor_.accept(candidate->time);
    head_ = std::move(candidate);
  }

  Pull pull_;
  StampMonitor monitor_;
  Duration offset_;                   ///< by shift()
  std::optional<Reading> head_;       ///< accepted, not yet taken
  std::optional<Reading> following_;  ///< seen, not yet accepted
};

}  // namespace lodeline

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stamp_bursts.h"
#include "lodeline/io/streams/stream_rate.h"
#include "lodeline/rig.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {

/// Expected properties of one sensor's stream.
struct StreamExpectation {
  std::string kind;  ///< prefix of the findings, e.g. "imu" for "imu_gap"
  std::string name;  ///< for messages, e.g. "cam1"
  double rate_hz = 0.0;
  double max_gap_s = 0.0;        ///< a longer pause is reported
  Duration offset_to_imu_clock;  ///< added to every stamp
  /// Number of readings read in advance where some are missing or time goes backwards, to sort in late ones.
  /// 1 for a live sensor, where reading in advance would mean waiting; 0 for a live camera.
  size_t look_ahead = 32;
  /// Whether readings that arrive in bursts get evenly spread times.
  bool spreads_bursts = false;
};

/// Checks the stamps of one stream and reports problems.
class StampMonitor {
 public:
  StampMonitor(StreamExpectation expectation, Diagnostics* diagnostics)
      : expectation_(std::move(expectation)), diagnostics_(diagnostics) {}

  const StreamExpectation& expectation() const { return expectation_; }

  /// Records an accepted stamp and reports a gap before it.
  void accept(Time time);
  std::optional<Time> last() const { return last_; }
  /// The stated period; without a stated rate, the last step; zero where neither is known.
  Duration period() const;
  /// Whether readings may be missing between the last accepted one and one at `time`.
  bool isHole(Time time) const;
  /// Whether the readings of `batch` are between `others` instead of filling holes: half of them are much
  /// closer than a period to one of `others`.
  bool overlaps(const std::vector<Time>& batch, const std::vector<Time>& others) const;

  void reportDuplicate(Time time) const;
  enum class Fate { PutInPlace, Dropped, FormerDropped };
  void reportDisorder(Time former, Time latter, Fate fate) const;
  void reportJumpBack(Time former, Time latter) const;
  void reportBursts(Duration period, Time first) const;
  /// Throws InputError for a stream that runs backwards.
  [[noreturn]] void refuseReversal(Time former, Time latter) const;

 private:
  StreamExpectation expectation_;
  Diagnostics* diagnostics_;
  std::optional<Time> last_;
  Duration last_step_;
};

/// Hash of a reading's values without its stamp.
uint64_t contentKey(const ImuSample& sample);
uint64_t contentKey(const MagnetometerSample& sample);
uint64_t contentKey(const DepthSample& sample);
uint64_t contentKey(const SonarSample& sample);
uint64_t contentKey(const AltimeterSample& sample);
uint64_t contentKey(const DvlSample& sample);
uint64_t contentKey(const CurrentSample& sample);

/// One sensor's readings with strictly increasing stamps on the IMU's clock. Late readings within the
/// look-ahead are sorted in; duplicates and later readings are dropped. Where the clock was set back, the
/// following readings continue without a pause. Readings in bursts are spread evenly. All this, and gaps, are
/// reported with stamps. Memory holds two readings, and the look-ahead where it is needed. A live stream
/// gives a reading at once after a step of a usual length. Throws InputError where the stream runs backwards.
template <typename Reading>
class OrderedStream {
 public:
  using Pull = std::function<std::optional<Reading>()>;

  OrderedStream(StreamExpectation expectation, Pull pull, Diagnostics* diagnostics)
      : pull_(std::move(pull)), monitor_(std::move(expectation), diagnostics) {}

  /// The next reading without removal from the stream; null at the end.
  const Reading* peek() {
    if (is_ready_) return &ahead_.front();
    fill();
    is_ready_ = !ahead_.empty();
    if (is_ready_) monitor_.accept(ahead_.front().time);
    return is_ready_ ? &ahead_.front() : nullptr;
  }

  /// The reading after that of peek(), if it is already known; null at the end.
  const Reading* following() const { return ahead_.size() > 1 ? &ahead_[1] : nullptr; }

  /// Shifts all readings that were not taken out yet.
  void shift(Duration by) {
    correction_ = correction_ + by;
    for (std::deque<Reading>* readings : {&ahead_, &unsorted_, &burst_}) {
      for (Reading& reading : *readings) reading.time = moved(reading.time, by);
    }
  }

  /// Removes and returns the next reading; valid only after peek() has returned one.
  Reading pop() {
    Reading reading = std::move(ahead_.front());
    recent_.emplace_back(reading.time, contentKey(reading));
    if (recent_.size() > kRecent) recent_.pop_front();
    ahead_.pop_front();
    is_ready_ = false;
    return reading;
  }

  /// Shifts all readings at or after `from`, where their clock jumped.
  void shiftFrom(Time from, Duration by) {
    if (pending_shift_ && is_past_jump_) correction_ = correction_ + pending_shift_->by;
    pending_shift_ = {from, by};
    is_past_jump_ = false;
    const auto moveFrom = [&](std::deque<Reading>* readings) {
      for (Reading& reading : *readings) move(&reading);
    };
    moveFrom(&ahead_);
    moveFrom(&unsorted_);
    moveFrom(&burst_);
  }

  /// Time of the last of the next `count` readings, or of the last reading before the end of the stream.
  /// Reads in advance. Returns nothing at the end.
  std::optional<Time> reach(size_t count, bool* ends) {
    peek();
    while (ahead_.size() < count && take()) {
    }
    *ends = ahead_.size() < count;
    return ahead_.empty() ? std::nullopt : std::optional(ahead_.back().time);
  }

 private:
  std::optional<Reading> pullRaw() {
    std::optional<Reading> reading = pull_();
    if (!reading) return reading;
    reading->time = moved(moved(reading->time, monitor_.expectation().offset_to_imu_clock), correction_);
    move(&*reading);
    return reading;
  }

  /// Shifts a reading after a clock jump. All readings after the first shifted one are shifted too.
  void move(Reading* reading) {
    if (!pending_shift_) return;
    if (!is_past_jump_ && reading->time < pending_shift_->from) return;
    is_past_jump_ = true;
    reading->time = moved(reading->time, pending_shift_->by);
  }

  /// The next reading in stored order, with bursts spread.
  std::optional<Reading> pull() {
    if (!unsorted_.empty()) {
      std::optional<Reading> reading = std::move(unsorted_.front());
      unsorted_.pop_front();
      return reading;
    }
    if (!monitor_.expectation().spreads_bursts) return pullRaw();
    if (!is_looked_at_) lookForBursts();
    if (!spreader_) {
      if (burst_.empty()) return pullRaw();
      std::optional<Reading> reading = std::move(burst_.front());
      burst_.pop_front();
      return reading;
    }
    return pullSpread();
  }

  /// Determines from the first readings whether they arrive in bursts.
  void lookForBursts() {
    is_looked_at_ = true;
    std::vector<Time> stamps;
    while (burst_.size() < kStampsForRate) {
      std::optional<Reading> reading = pullRaw();
      if (!reading) break;
      const bool is_repeat = !burst_.empty() && burst_.back().time == reading->time &&
                             contentKey(burst_.back()) == contentKey(*reading);
      if (!is_repeat) stamps.push_back(reading->time);
      burst_.push_back(std::move(*reading));
    }
    const std::optional<Duration> period = burstPeriod(stamps);
    if (!period) return;
    spreader_.emplace(*period);
    monitor_.reportBursts(*period, stamps.front());
  }

  /// The first reading of the next burst; its other readings are placed before the unsorted ones.
  std::optional<Reading> pullSpread() {
    constexpr size_t kLargestBurst = 200;
    size_t size = burst_.empty() ? 0 : 1;
    for (; size < kLargestBurst; ++size) {
      if (size == burst_.size()) {
        std::optional<Reading> next = pullRaw();
        if (!next) break;
        burst_.push_back(std::move(*next));
      }
      if (size > 0 && spreader_->separates(burst_[size - 1].time, burst_[size].time)) break;
    }
    std::vector<Time> stamps;
    for (size_t i = 0; i < size; ++i) stamps.push_back(burst_[i].time);
    if (stamps.empty()) return std::nullopt;
    const std::vector<Time> times = spreader_->spread(stamps);
    for (size_t i = 0; i < size; ++i) {
      unsorted_.push_back(std::move(burst_.front()));
      unsorted_.back().time = times[i];
      burst_.pop_front();
    }
    std::optional<Reading> first = std::move(unsorted_.front());
    unsorted_.pop_front();
    return first;
  }

  /// Reads in advance until the front is certain to be the next reading.
  void fill() {
    while (ahead_.size() < 2 && !isCertainAlone() && take()) {
    }
    if (ahead_.empty() || !monitor_.isHole(ahead_.front().time)) return;
    while (ahead_.size() <= monitor_.expectation().look_ahead && take()) {
    }
  }

  /// Whether the only reading is certain to be the next one: a step of a usual length, so that no reading is
  /// missing before it and its stamp is not wild. Only for a live sensor; others have their successors at
  /// hand.
  bool isCertainAlone() const {
    if (monitor_.expectation().look_ahead > 1 || ahead_.size() != 1 || !monitor_.last()) return false;
    const Time time = ahead_.front().time;
    return !monitor_.isHole(time) && span(time, *monitor_.last()) <= kWildLeap;
  }

  /// Reads one more reading and sorts it in; returns false at the end.
  bool take() {
    std::optional<Reading> reading = pull();
    if (!reading) return false;
    const std::optional<Time> newest = ahead_.empty() ? monitor_.last() : std::optional(ahead_.back().time);
    const bool is_newest = !newest || reading->time > *newest;
    if (!is_newest && reading->time == *newest) {
      monitor_.reportDuplicate(reading->time);
    } else if (!is_newest && !dropWildStamps(reading->time)) {
      sortOut(std::move(*reading), *newest);
    } else {
      ahead_.push_back(std::move(*reading));
    }
    return true;
  }

  /// Drops up to kMostWild last readings that jumped ahead by more than a second while their successor at
  /// `time` did not. Their stamps are damaged; without this, all later readings would be rejected as late.
  bool dropWildStamps(Time time) {
    constexpr size_t kMostWild = 3;
    const auto first = std::find_if(ahead_.begin() + (is_ready_ ? 1 : 0), ahead_.end(),
                                    [&](const Reading& reading) { return reading.time >= time; });
    const auto count = static_cast<size_t>(ahead_.end() - first);
    if (count == 0 || count > kMostWild || span(first->time, time) <= kWildLeap) return false;
    const std::optional<Time> before =
        first == ahead_.begin() ? monitor_.last() : std::optional((first - 1)->time);
    if (before && time <= *before) return false;
    monitor_.reportDisorder(first->time, time, StampMonitor::Fate::FormerDropped);
    ahead_.erase(first, ahead_.end());
    return true;
  }

  /// Handles a time that is before `newest`: late readings, or a clock that was set back.
  void sortOut(Reading reading, Time newest) {
    std::vector<Reading> batch;
    batch.push_back(std::move(reading));
    std::optional<Reading> beyond;
    size_t descents = 0;
    while (batch.size() < monitor_.expectation().look_ahead) {
      std::optional<Reading> next = pull();
      if (!next) break;
      if (next->time > newest) {
        beyond = std::move(next);
        break;
      }
      descents += next->time <= batch.back().time ? 1 : 0;
      batch.push_back(std::move(*next));
    }
    const bool is_full = !beyond && batch.size() >= monitor_.expectation().look_ahead && batch.size() > 1;
    if (is_full && descents + 1 == batch.size()) monitor_.refuseReversal(newest, batch.back().time);
    const bool may_be_set_back = batch.size() > 1 && (is_full ? 4 * descents < batch.size() : descents == 0);
    const bool was_set_back = may_be_set_back && !repeats(batch) && (is_full || liesBetween(batch));
    if (was_set_back) {
      followOn(&batch, newest);
      if (beyond) beyond->time = moved(beyond->time, set_back_by_);
    }
    if (beyond) batch.push_back(std::move(*beyond));
    if (was_set_back) {
      unsorted_.insert(unsorted_.begin(), std::make_move_iterator(batch.begin()),
                       std::make_move_iterator(batch.end()));
      return;
    }
    for (Reading& late : batch) putInPlace(std::move(late), newest);
  }

  /// Whether most readings of a batch repeat earlier readings exactly.
  bool repeats(const std::vector<Reading>& batch) const {
    size_t count = 0;
    for (const Reading& reading : batch) {
      const auto isTheSame = [&, key = contentKey(reading)](Time time, uint64_t other) {
        return time == reading.time && other == key;
      };
      count += std::any_of(recent_.begin(), recent_.end(),
                           [&](const auto& other) { return isTheSame(other.first, other.second); }) ||
                       std::any_of(ahead_.begin(), ahead_.end(),
                                   [&](const Reading& o) { return isTheSame(o.time, contentKey(o)); })
                   ? 1
                   : 0;
    }
    return 2 * count >= batch.size();
  }

  bool liesBetween(const std::vector<Reading>& batch) const {
    std::vector<Time> times, others;
    for (const auto& other : recent_) others.push_back(other.first);
    for (const Reading& other : ahead_) others.push_back(other.time);
    for (const Reading& reading : batch) times.push_back(reading.time);
    return monitor_.overlaps(times, others);
  }

  void followOn(std::vector<Reading>* batch, Time newest) {
    monitor_.reportJumpBack(newest, batch->front().time);
    set_back_by_ = span(moved(newest, monitor_.period()), batch->front().time);
    correction_ = correction_ + set_back_by_;
    for (Reading& reading : *batch) reading.time = moved(reading.time, set_back_by_);
    for (Reading& reading : unsorted_) reading.time = moved(reading.time, set_back_by_);
    for (Reading& reading : burst_) reading.time = moved(reading.time, set_back_by_);
  }

  void putInPlace(Reading reading, Time newest) {
    using Fate = StampMonitor::Fate;
    const Time time = reading.time;
    const auto place =
        std::find_if(ahead_.begin(), ahead_.end(), [&](const Reading& other) { return other.time >= time; });
    if (place != ahead_.end() && place->time == time) {
      monitor_.reportDuplicate(time);
    } else if ((monitor_.last() && time <= *monitor_.last()) || (is_ready_ && place == ahead_.begin())) {
      monitor_.reportDisorder(newest, time, Fate::Dropped);
    } else {
      if (time < newest) monitor_.reportDisorder(newest, time, Fate::PutInPlace);
      ahead_.insert(place, std::move(reading));
    }
  }

  struct Shift {
    Time from;
    Duration by;
  };
  static constexpr size_t kRecent = 1000;
  static constexpr Duration kWildLeap = Duration::fromNanoseconds(1'000'000'000);

  Pull pull_;
  StampMonitor monitor_;
  std::deque<Reading> ahead_;     ///< in order, later than the readings already removed
  bool is_ready_ = false;         ///< whether the front is accepted
  std::deque<Reading> unsorted_;  ///< pulled; they precede the unread part of the recording
  Duration correction_;           ///< added to the stamps of the unread part
  Duration set_back_by_;          ///< size of the jump found last
  std::optional<Shift> pending_shift_;
  bool is_past_jump_ = false;
  bool is_looked_at_ = false;  ///< whether burst detection is done
  std::deque<Reading> burst_;  ///< readings of a burst, not spread yet
  std::optional<BurstSpreader> spreader_;
  std::deque<std::pair<Time, uint64_t>> recent_;  ///< stamps and contents of the readings removed last
};

}  // namespace lodeline

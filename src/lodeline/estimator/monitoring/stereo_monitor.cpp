#include "lodeline/estimator/monitoring/stereo_monitor.h"

#include <fmt/format.h>

#include <algorithm>

#include "lodeline/frontend/detection/mask.h"

namespace lodeline {
namespace {

constexpr int kFewTracks = 30;  // of camera 0; fewer allow no decision
constexpr double kFewMatched = 0.2, kMuchFewerMatched = 0.4;
constexpr double kFirstWait_s = 0.1, kLongestWait_s = 8.0;

std::string clockTime(Duration since_start) {
  const int64_t ms = (since_start.nanoseconds() + 500'000) / 1'000'000;
  return fmt::format("{}:{:02}.{:03}", ms / 60'000, ms / 1000 % 60, ms % 1000);
}

}  // namespace

StereoMonitor::StereoMonitor(const Rig& rig, Diagnostics* diagnostics)
    : rig_(rig), diagnostics_(diagnostics) {
  for (size_t i = 1; i < rig.cameras.size(); ++i) {
    Partner partner;
    partner.name = rig.cameras[i].name;
    partner.wait_s = kFirstWait_s;
    partners_.push_back(std::move(partner));
  }
}

std::vector<cv::Mat> StereoMonitor::arrange(const FramePacket& packet) {
  std::vector<cv::Mat> images = packet.images;
  if (is_exchanged_) std::swap(images[0], images[1]);
  for (size_t i = 0; i < partners_.size(); ++i) {
    if (partners_[i].is_left_out) images[i + 1] = cv::Mat();
  }
  return images;
}

bool StereoMonitor::isDoubtful(const Partner& partner, int tracks, int matches) const {
  if (partner.is_left_out) return true;
  if (tracks < kFewTracks) return false;
  constexpr int kKnown = 10;
  const double share = static_cast<double>(matches) / tracks;
  return share < kFewMatched || (partner.frames >= kKnown && share < kMuchFewerMatched * partner.usual_share);
}

bool StereoMonitor::judge(const FramePacket& packet, const std::vector<cv::Mat>& images,
                          const FrameTracks& tracks) {
  if (first_time_) watched_s_ = (packet.time - *first_time_).seconds();
  first_time_ = first_time_.value_or(packet.time);
  std::vector<int> counts(rig_.cameras.size());
  for (const FeatureObservation& observation : tracks.observations)
    ++counts[static_cast<size_t>(observation.camera)];
  for (size_t i = 0; i < partners_.size(); ++i) {
    Partner& partner = partners_[i];
    if (images[0].empty()) continue;
    constexpr int kAlone = 5;
    followSpan(packet.time, counts[0] >= kFewTracks && counts[i + 1] < kAlone, &partner);
    if (packet.images[i + 1].empty()) continue;
    if (!isDoubtful(partner, counts[0], counts[i + 1])) {
      constexpr double kMemory = 20.0;
      constexpr int kConfirms = 10;
      partner.frames += 1;
      if (i == 0 && partner.frames >= kConfirms) is_exchange_on_trial_ = false;
      const double share = static_cast<double>(counts[i + 1]) / std::max(1, counts[0]);
      partner.usual_share += (share - partner.usual_share) / std::min<double>(partner.frames, kMemory);
      continue;
    }
    const std::optional<StereoSurvey> survey = look(packet, images, i + 1);
    if (survey && conclude(packet, *survey, i + 1)) return true;
  }
  return false;
}

std::optional<StereoSurvey> StereoMonitor::look(const FramePacket& packet, const std::vector<cv::Mat>& images,
                                                size_t camera) {
  constexpr double kOldest_s = 2.0;
  constexpr int kEnough = 60;
  Partner& partner = partners_[camera - 1];
  if (partner.last_look && (packet.time - *partner.last_look).seconds() < partner.wait_s) return std::nullopt;
  if (partner.last_look && (packet.time - *partner.last_look).seconds() > kOldest_s) partner.points.clear();
  partner.last_look = packet.time;
  const cv::Mat& other = is_exchanged_ && camera == 1 ? packet.images[0] : packet.images[camera];
  if (other.size() != images[0].size()) return std::nullopt;
  const std::vector<PointPair> found = matchStereo(images[0], other, cv::Mat());
  partner.points.insert(partner.points.end(), found.begin(), found.end());
  StereoSurvey survey = compareStereo(rig_.cameras[0], rig_.cameras[camera], partner.points);
  if (survey.points < kEnough) return std::nullopt;
  partner.points.clear();
  return survey;
}

bool StereoMonitor::exchange(const FramePacket& packet, const StereoSurvey& survey) {
  Partner& partner = partners_.front();
  is_exchanged_ = !is_exchanged_;
  is_exchange_on_trial_ = true;
  partner.contradictions = partner.exchanges = 0;
  partner.usual_share = 0.0;
  partner.frames = 0;
  diagnostics_->report(
      Severity::Serious, "cameras_swapped",
      fmt::format(
          "{} and {}: at {} (stamp {} ns) left and right are exchanged: {:.0f} % of the points that both see "
          "contradict the calibration, {:.0f} % fit if each image is the other camera's; used so from there "
          "on. Look at the connectors, the order of the topics or folders, and the calibration files; "
          "`lodeline inspect` tells more",
          rig_.cameras[0].name, partner.name, clockTime(packet.time - *first_time_),
          packet.image_stamp.nanoseconds(), 100.0 * (1.0 - survey.agreement), 100.0 * survey.best_agreement));
  return true;
}

bool StereoMonitor::conclude(const FramePacket& packet, const StereoSurvey& survey, size_t camera) {
  constexpr double kContradicts = 0.3, kFits = 0.7;
  constexpr int kSure = 3;
  Partner& partner = partners_[camera - 1];
  const bool contradicts = survey.agreement < kContradicts;
  const bool looks_exchanged = contradicts && survey.best_agreement > kFits && camera == 1 &&
                               std::find(survey.fitting.begin(), survey.fitting.end(),
                                         StereoHypothesis::ImagesExchanged) != survey.fitting.end();
  partner.exchanges = looks_exchanged ? partner.exchanges + 1 : 0;
  if (partner.exchanges >= (was_exchange_wrong_ ? kSure : 1)) return exchange(packet, survey);
  if (contradicts && camera == 1 && is_exchange_on_trial_) {
    is_exchanged_ = !is_exchanged_;
    is_exchange_on_trial_ = false;
    was_exchange_wrong_ = true;
    partner.contradictions = 1;
    return true;
  }
  if (!contradicts) {
    partner.contradictions = 0;
    if (survey.agreement > kFits) {
      partner.is_left_out = false;
      is_exchange_on_trial_ = is_exchange_on_trial_ && camera != 1;
    }
    partner.wait_s = std::min(kLongestWait_s, 2.0 * partner.wait_s);
    return false;
  }
  partner.wait_s = std::max(partner.wait_s, 0.5);
  if (++partner.contradictions < kSure || partner.is_left_out) return false;
  partner.is_left_out = true;
  diagnostics_->report(
      Severity::Serious, "stereo_contradicts",
      fmt::format(
          "{}: at {} (stamp {} ns) {:.0f} % of the points that {} sees as well contradict the "
          "calibration, and no exchange of the cameras explains it; its images are left out until they "
          "fit. Do they belong to the same moment? Is the calibration that of this rig? `lodeline "
          "inspect` tells more",
          partner.name, clockTime(packet.time - *first_time_), packet.image_stamp.nanoseconds(),
          100.0 * (1.0 - survey.agreement), rig_.cameras[0].name));
  return false;
}

void StereoMonitor::followSpan(Time time, bool is_alone, Partner* partner) {
  if (is_alone && !partner->is_alone) partner->alone.begin = time;
  if (is_alone) partner->alone.end = time;
  if (!is_alone && partner->is_alone) close(partner);
  partner->is_alone = is_alone;
}

void StereoMonitor::close(Partner* partner) {
  constexpr double kWorthSaying_s = 0.5;
  partner->is_alone = false;
  const double length_s = partner->alone.length_s();
  if (length_s < kWorthSaying_s) return;
  ++partner->spans;
  partner->alone_s += length_s;
  if (length_s > partner->longest.length_s()) partner->longest = partner->alone;
}

void StereoMonitor::finish() {
  for (Partner& partner : partners_) {
    if (partner.is_alone) close(&partner);
    if (partner.spans == 0) continue;
    diagnostics_->report(
        Severity::Warning, "one_camera",
        fmt::format(
            "{} gave no matches for {:.1f} of {:.1f} s (the longest time from {} to {}): {} was alone, "
            "and the scale hung on the accelerometer",
            partner.name, partner.alone_s, watched_s_, clockTime(partner.longest.begin - *first_time_),
            clockTime(partner.longest.end - *first_time_), rig_.cameras[0].name));
  }
}

}  // namespace lodeline

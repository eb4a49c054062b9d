#include "lodeline/odometry.h"

#include <utility>

#include "lodeline/api/odometry_implementation.h"
#include "lodeline/api/recording_check.h"
#include "lodeline/batch/refine.h"

namespace lodeline {
namespace {

/// The settings of a run over this source, with the field at the site for true north.
RunSettings optionsFor(const OdometrySettings& settings, const RecordedSource& source) {
  if (source.rig().cameras.empty()) throw InputError("odometry: the rig has no camera");
  RunSettings options = settings.values().options;
  options.odometry.estimator.magnetometer.site_field_W = siteField_W(options);
  // A live source gives the next image only when it has been taken.
  options.synchronizer.prefetch &= !source.isLive();
  return options;
}

}  // namespace

OdometrySettings::OdometrySettings() : values_(std::make_unique<Values>()) {
  bindRunSettings(&values_->settings, &values_->options);
}
OdometrySettings::~OdometrySettings() = default;
OdometrySettings::OdometrySettings(OdometrySettings&&) noexcept = default;
OdometrySettings& OdometrySettings::operator=(OdometrySettings&&) noexcept = default;

void OdometrySettings::load(const std::filesystem::path& file) { values_->settings.load(file); }
void OdometrySettings::set(const std::string& key, const std::string& value) {
  values_->settings.set(key, value);
}
void OdometrySettings::write(std::ostream& stream) const { values_->settings.write(stream); }

EurocOptions OdometrySettings::recording() const { return values_->options.source; }

void OdometrySettings::adaptTo(const RecordingOpener& open, const std::string& name,
                               Diagnostics* diagnostics) {
  checkRecording(open, name, &values_->options, diagnostics);
}

Odometry::Odometry(RecordedSource* source, const OdometrySettings& settings, Diagnostics* diagnostics)
    : implementation_(new Implementation{{optionsFor(settings, *source), source, diagnostics}}) {}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;
Odometry& Odometry::operator=(Odometry&&) noexcept = default;

std::optional<FrameEstimate> Odometry::next() {
  EstimationLoop& loop = implementation_->loop;
  while (!implementation_->has_ended && loop.fetch()) {
    loop.process();
    if (!loop.hasNewStamp()) continue;
    implementation_->has_pose |= loop.estimate().status != Status::Waiting;
    return loop.estimate();
  }
  if (!std::exchange(implementation_->has_ended, true)) loop.finish();
  return std::nullopt;
}

std::vector<MapPoint> Odometry::takeLandmarks() {
  Estimator& estimator = implementation_->loop.odometry().estimator();
  std::vector<MapPoint> landmarks = estimator.takeMapPoints();
  if (implementation_->has_ended && !std::exchange(implementation_->are_last_landmarks_taken, true)) {
    for (const MapPoint& point : estimator.currentMapPoints()) landmarks.push_back(point);
  }
  return landmarks;
}

void Odometry::keepForRefinement(double state_interval_s) { implementation_->loop.record(state_interval_s); }

Refinement Odometry::refine() const {
  const EstimationLoop& loop = implementation_->loop;
  if (!loop.log()) throw UsageError("refine: call keepForRefinement() before the first next()");
  if (!implementation_->has_ended) throw UsageError("refine: call next() until it returns nothing");
  if (!implementation_->has_pose) throw EstimationError("refine: the recording has no pose");
  const Estimator& estimator = loop.odometry().estimator();
  return lodeline::refine(estimator.rig(), estimator.options(), *loop.log());
}

}  // namespace lodeline

#include "lodeline/io/synchronizer/thinned_source.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

ThinnedSource::ThinnedSource(std::unique_ptr<RecordedSource> source, int step)
    : RecordedSource(source->rig(), source->imuCorrection()), source_(std::move(source)), step_(step) {
  for (CameraCalibration& camera : rig_.cameras) {
    period_s_.push_back(1.0 / camera.rate_hz);
    camera.rate_hz /= step_;
  }
  last_.resize(rig_.cameras.size());
}

std::optional<PendingImage> ThinnedSource::nextImage(size_t camera) {
  while (std::optional<PendingImage> image = source_->nextImage(camera)) {
    if (!first_) first_ = Position{image->time, 0};
    const Position& before = last_[camera] ? *last_[camera] : *first_;
    const int64_t since = std::llround((image->time - before.time).seconds() / period_s_[camera]);
    last_[camera] = Position{image->time, before.number + since};
    if (last_[camera]->number % step_ == 0) return image;
  }
  return std::nullopt;
}

std::unique_ptr<RecordedSource> everyNthImage(std::unique_ptr<RecordedSource> source, int step) {
  if (step < 1) throw UsageError(fmt::format("source.image_step: {} is below 1", step));
  if (step == 1) return source;
  return std::make_unique<ThinnedSource>(std::move(source), step);
}

}  // namespace lodeline

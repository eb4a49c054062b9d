#include "lodeline/inspection/survey/excerpt_source.h"

#include <utility>

namespace lodeline {

ExcerptSource::ExcerptSource(std::unique_ptr<MeasurementSource> source, double begin_s, double length_s)
    : source_(std::move(source)) {
  if (!source_->rig().cameras.empty()) first_image_ = source_->nextImage(0);
  if (!first_image_) first_imu_ = source_->nextImu();
  if (first_imu_) begin_ = first_imu_->time + Duration::fromSeconds(begin_s);
  if (first_image_) begin_ = first_image_->time + Duration::fromSeconds(begin_s);
  end_ = begin_ + Duration::fromSeconds(length_s);
}

template <typename Next>
auto ExcerptSource::within(Time begin, const Next& next) -> decltype(next()) {
  auto reading = next();
  while (reading && reading->time < begin) reading = next();
  if (reading && reading->time > end_) reading.reset();
  return reading;
}

std::optional<ImuSample> ExcerptSource::nextImu() {
  return within(begin_ - Duration::fromSeconds(1.0),
                [&] { return first_imu_ ? std::exchange(first_imu_, std::nullopt) : source_->nextImu(); });
}

std::optional<PendingImage> ExcerptSource::nextImage(size_t camera) {
  return within(begin_, [&] {
    return camera == 0 && first_image_ ? std::exchange(first_image_, std::nullopt)
                                       : source_->nextImage(camera);
  });
}

std::optional<MagnetometerSample> ExcerptSource::nextMagnetometer() {
  return within(begin_, [&] { return source_->nextMagnetometer(); });
}

std::optional<DepthSample> ExcerptSource::nextDepth() {
  return within(begin_, [&] { return source_->nextDepth(); });
}

std::optional<SonarSample> ExcerptSource::nextSonar() {
  return within(begin_, [&] { return source_->nextSonar(); });
}

std::optional<AltimeterSample> ExcerptSource::nextAltimeter() {
  return within(begin_, [&] { return source_->nextAltimeter(); });
}

std::optional<DvlSample> ExcerptSource::nextDvl() {
  return within(begin_, [&] { return source_->nextDvl(); });
}

std::optional<CurrentSample> ExcerptSource::nextCurrents() {
  return within(begin_, [&] { return source_->nextCurrents(); });
}

}  // namespace lodeline

#include "lodeline/io/rosbag/convert/part_source.h"

namespace lodeline {
namespace {

/// Readings of one stream may be out of order by so much; later ones end it.
constexpr double kMostDisorder_s = 10.0;

template <typename Reading>
void takeEarliest(const std::optional<Reading>& reading, std::optional<Time>* earliest) {
  if (reading && (!*earliest || reading->time < **earliest)) *earliest = reading->time;
}

}  // namespace

bool PartOfRecording::contains(Time start, Time time) const {
  const double since_s = (time - start).seconds();
  return since_s >= from_s && (!length_s || since_s <= from_s + *length_s);
}

PartSource::PartSource(RecordedSource* whole, const PartOfRecording& part)
    : RecordedSource(whole->rig(), whole->imuCorrection()), whole_(whole), part_(part) {
  first_images_.resize(rig().cameras.size());
  if (part_.isAll()) return;
  std::optional<Time> earliest;
  for (size_t i = 0; i < first_images_.size(); ++i) {
    first_images_[i] = whole_->nextImage(i);
    takeEarliest(first_images_[i], &earliest);
  }
  const auto take = [&](auto* first, auto reading) {
    *first = std::move(reading);
    takeEarliest(*first, &earliest);
  };
  take(&first_imu_, whole_->nextRecordedImu());
  take(&first_magnetometer_, whole_->nextMagnetometer());
  take(&first_depth_, whole_->nextDepth());
  take(&first_sonar_, whole_->nextSonar());
  take(&first_altimeter_, whole_->nextAltimeter());
  take(&first_dvl_, whole_->nextDvl());
  take(&first_currents_, whole_->nextCurrents());
  if (earliest) start_ = *earliest;
}

template <typename Reading, typename Pull>
std::optional<Reading> PartSource::next(std::optional<Reading>* first, const Pull& pull) const {
  while (true) {
    std::optional<Reading> reading = *first ? std::exchange(*first, std::nullopt) : pull();
    if (!reading || contains(reading->time)) return reading;
    const double since_s = (reading->time - start_).seconds();
    if (part_.length_s && since_s > part_.from_s + *part_.length_s + kMostDisorder_s) return std::nullopt;
  }
}

std::optional<PendingImage> PartSource::nextImage(size_t camera) {
  return next(&first_images_.at(camera), [&] { return whole_->nextImage(camera); });
}

std::optional<ImuSample> PartSource::nextRecordedImu() {
  return next(&first_imu_, [&] { return whole_->nextRecordedImu(); });
}

std::optional<MagnetometerSample> PartSource::nextMagnetometer() {
  return next(&first_magnetometer_, [&] { return whole_->nextMagnetometer(); });
}

std::optional<DepthSample> PartSource::nextDepth() {
  return next(&first_depth_, [&] { return whole_->nextDepth(); });
}

std::optional<SonarSample> PartSource::nextSonar() {
  return next(&first_sonar_, [&] { return whole_->nextSonar(); });
}

std::optional<AltimeterSample> PartSource::nextAltimeter() {
  return next(&first_altimeter_, [&] { return whole_->nextAltimeter(); });
}

std::optional<DvlSample> PartSource::nextDvl() {
  return next(&first_dvl_, [&] { return whole_->nextDvl(); });
}

std::optional<CurrentSample> PartSource::nextCurrents() {
  return next(&first_currents_, [&] { return whole_->nextCurrents(); });
}

}  // namespace lodeline

#pragma once

#include <utility>
#include <vector>

#include "lodeline/recording.h"

namespace lodeline {

/// Part of a recording, in seconds from its first reading of any sensor.
struct PartOfRecording {
  double from_s = 0.0;
  std::optional<double> length_s;  ///< nothing: to the end

  bool isAll() const { return from_s <= 0.0 && !length_s; }
  /// Whether a time lies in the part of a recording that starts at `start`.
  bool contains(Time start, Time time) const;
};

/// The readings of another source that lie in a part of it, as stored and in the same order.
class PartSource final : public RecordedSource {
 public:
  /// `whole` must outlive this source.
  PartSource(RecordedSource* whole, const PartOfRecording& part);

  bool contains(Time time) const { return part_.isAll() || part_.contains(start_, time); }
  std::optional<double> shareRead() const override { return whole_->shareRead(); }
  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;
  std::optional<SonarSample> nextSonar() override;
  std::optional<AltimeterSample> nextAltimeter() override;
  std::optional<DvlSample> nextDvl() override;
  std::optional<CurrentSample> nextCurrents() override;

 private:
  template <typename Reading, typename Pull>
  std::optional<Reading> next(std::optional<Reading>* first, const Pull& pull) const;

  RecordedSource* whole_;
  PartOfRecording part_;
  Time start_;
  // First readings, which tell the start and are not handed on yet.
  std::vector<std::optional<PendingImage>> first_images_;
  std::optional<ImuSample> first_imu_;
  std::optional<MagnetometerSample> first_magnetometer_;
  std::optional<DepthSample> first_depth_;
  std::optional<SonarSample> first_sonar_;
  std::optional<AltimeterSample> first_altimeter_;
  std::optional<DvlSample> first_dvl_;
  std::optional<CurrentSample> first_currents_;
};

}  // namespace lodeline

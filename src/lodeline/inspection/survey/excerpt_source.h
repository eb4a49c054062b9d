#pragma once

#include <memory>

#include "lodeline/recording.h"

namespace lodeline {

/// Part of a recording: the readings with time stamps from `begin_s` after the first image of the first
/// camera on (without cameras, after the first inertial reading), for `length_s`. Inertial readings begin a
/// second earlier. Every stream ends at its first reading beyond the part, so that the rest of the recording
/// is not read.
class ExcerptSource : public MeasurementSource {
 public:
  ExcerptSource(std::unique_ptr<MeasurementSource> source, double begin_s, double length_s);

  const Rig& rig() const override { return source_->rig(); }
  std::optional<ImuSample> nextImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<DepthSample> nextDepth() override;
  std::optional<SonarSample> nextSonar() override;
  std::optional<AltimeterSample> nextAltimeter() override;
  std::optional<DvlSample> nextDvl() override;
  std::optional<CurrentSample> nextCurrents() override;

 private:
  template <typename Next>
  auto within(Time begin, const Next& next) -> decltype(next());

  std::unique_ptr<MeasurementSource> source_;
  std::optional<PendingImage> first_image_;  ///< read, not yet returned
  std::optional<ImuSample> first_imu_;       ///< likewise
  Time begin_, end_;
};

}  // namespace lodeline

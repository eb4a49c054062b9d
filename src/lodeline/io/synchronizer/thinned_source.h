#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/recording.h"

namespace lodeline {

/// A recording of which every Nth image is used, as if the cameras were N times slower. Images are counted by
/// their stamps and rates, so that a lost image of one camera does not part it from the others.
class ThinnedSource : public RecordedSource {
 public:
  /// `step`: N, at least 1.
  ThinnedSource(std::unique_ptr<RecordedSource> source, int step);

  std::optional<ImuSample> nextRecordedImu() override { return source_->nextRecordedImu(); }
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override { return source_->nextMagnetometer(); }
  std::optional<DepthSample> nextDepth() override { return source_->nextDepth(); }
  std::optional<SonarSample> nextSonar() override { return source_->nextSonar(); }
  std::optional<AltimeterSample> nextAltimeter() override { return source_->nextAltimeter(); }
  std::optional<DvlSample> nextDvl() override { return source_->nextDvl(); }
  std::optional<CurrentSample> nextCurrents() override { return source_->nextCurrents(); }
  std::optional<double> shareRead() const override { return source_->shareRead(); }

 private:
  /// Time and number of a camera's last image.
  struct Position {
    Time time;
    int64_t number = 0;
  };

  std::unique_ptr<RecordedSource> source_;
  int step_;
  std::vector<double> period_s_;
  std::optional<Position> first_;  ///< of any camera
  std::vector<std::optional<Position>> last_;
};

/// `source` itself for step 1, otherwise a ThinnedSource. Throws UsageError for a step below 1.
std::unique_ptr<RecordedSource> everyNthImage(std::unique_ptr<RecordedSource> source, int step);

}  // namespace lodeline

#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/video/film_chapter.h"
#include "lodeline/io/video/frame_stamps.h"
#include "lodeline/io/video/video_sensors.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Parts of a film to read. The defaults fit trajectory estimation.
struct VideoOptions {
  /// Files that describe the rig; without them NAME.rig.yaml beside the film.
  std::vector<std::filesystem::path> rig_files = {};
  /// The camera of the rig that made the film; may be empty where the rig has one.
  std::vector<int> camera_indices = {};
  bool with_cameras = true;
  /// False accepts a film without rig or inertial readings. Sensors without calibration get the default one.
  bool needs_calibration = true;
};

/// A film with inertial readings as a recording of one camera: a GoPro film (all its chapters) with GPMF
/// telemetry, or the folder of a phone's logger with a film and tables of readings (findVideoFolder). Images
/// are decoded on demand, and scaled down to the resolution of the rig.
class VideoSource : public RecordedSource {
 public:
  /// Throws InputError where the film cannot be read or has no inertial readings. The same holds for a rig
  /// that does not describe one camera with the images' proportions. `diagnostics` must outlive the source.
  VideoSource(const std::filesystem::path& data, const VideoOptions& options, Diagnostics* diagnostics);

  std::optional<ImuSample> nextRecordedImu() override;
  std::optional<PendingImage> nextImage(size_t camera) override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::optional<double> shareRead() const override;

  const RigFile& rigFile() const { return rig_file_; }
  const std::vector<FilmChapter>& chapters() const { return chapters_; }
  /// Null where nothing but images was found.
  const VideoSensors* sensors() const { return sensors_.get(); }

 private:
  void openFilm(const std::filesystem::path& data);
  void settleCamera(const VideoOptions& options);
  void settleImu(const VideoOptions& options);
  void settleMagnetometer(const VideoOptions& options);
  std::optional<Duration> nextInChapter();
  std::optional<Time> stampOf(Duration time);

  std::string name_;
  Diagnostics* diagnostics_;
  std::vector<FilmChapter> chapters_;
  std::unique_ptr<VideoSensors> sensors_;
  std::optional<FrameStamps> stamps_;
  RigFile rig_file_;
  cv::Size image_size_;

  // Position in the images.
  size_t chapter_ = 0;
  std::optional<FilmFrameTimes> times_;
  std::shared_ptr<FilmDecoder> decoder_;
};

}  // namespace lodeline

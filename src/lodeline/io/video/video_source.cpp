#include "lodeline/io/video/video_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stream_rate.h"
#include "lodeline/io/video/chapters.h"
#include "lodeline/io/video/gpmf_sensors.h"
#include "lodeline/io/video/table_sensors.h"
#include "lodeline/io/video/video_folder.h"

namespace lodeline {
namespace {

/// Difference of proportions that rounding to whole pixels explains.
constexpr double kSameProportions_px = 1.0;

/// Whether images of `film` scaled to `rig` keep their proportions.
bool haveSameProportions(cv::Size film, cv::Size rig) {
  const double scaled_height = static_cast<double>(film.height) * rig.width / film.width;
  return std::abs(scaled_height - rig.height) <= kSameProportions_px;
}

}  // namespace

VideoSource::VideoSource(const std::filesystem::path& data, const VideoOptions& options,
                         Diagnostics* diagnostics)
    : RecordedSource(Rig()), name_(data.string()), diagnostics_(diagnostics) {
  openFilm(data);
  rig_file_ = readRigOf(data, "a film", options.rig_files, options.needs_calibration, diagnostics);
  if (!rig_file_.has_imu && options.needs_calibration) {
    throw InputError(name_ + ": the rig file has no section imu0; its noise densities are needed");
  }
  if (options.needs_calibration && (!sensors_ || !sensors_->hasImu())) {
    throw InputError(name_ +
                     ": has no inertial readings (no telemetry track with GYRO and ACCL, and no tables "
                     "beside it that belong to it); a trajectory cannot be estimated from images alone");
  }
  rig_ = rig_file_.rig;
  imu_correction_ = rig_file_.imu_correction;
  rig_.pressure.reset();
  rig_.sonar.reset();
  rig_.altimeter.reset();
  rig_.dvl.reset();
  rig_.currents.reset();
  settleCamera(options);
  settleImu(options);
  settleMagnetometer(options);
}

void VideoSource::openFilm(const std::filesystem::path& data) {
  const std::optional<VideoFolder> folder = findVideoFolder(data);
  const std::filesystem::path film = folder ? folder->film : data;
  chapters_ = joinChapters(chaptersFrom(film, diagnostics_));
  const FilmTrack& images = chapters_.front().images;
  image_size_ = cv::Size(images.width_px, images.height_px);
  if (folder) {
    sensors_ = std::make_unique<TableSensors>(*folder, diagnostics_);
    stamps_.emplace(folder->stamps, diagnostics_);
  } else {
    const bool has_telemetry = std::any_of(chapters_.begin(), chapters_.end(),
                                           [](const FilmChapter& c) { return c.telemetry.has_value(); });
    if (has_telemetry) sensors_ = std::make_unique<GpmfSensors>(chapters_, diagnostics_);
  }
  if (images.turned_deg != 0.0) {
    diagnostics_->report(
        Severity::Notice, "video_turned",
        fmt::format("{}: players turn the images by {:.0f} deg; they are used as stored, and "
                    "the calibration must be of images as stored",
                    film.string(), images.turned_deg));
  }
}

void VideoSource::settleCamera(const VideoOptions& options) {
  if (!options.with_cameras) {
    rig_.cameras.clear();
    return;
  }
  if (rig_.cameras.empty() && !options.needs_calibration) {
    CameraCalibration camera;
    camera.name = "cam0";
    camera.rate_hz = 0.0;
    rig_.cameras.push_back(camera);
  }
  selectCameras(options.camera_indices, name_, &rig_);
  if (rig_.cameras.size() != 1) {
    throw InputError(
        fmt::format("{}: a film is of one camera, but the rig describes {}; name the one with "
                    "--set source.cameras=[N]",
                    name_, rig_.cameras.size()));
  }
  CameraCalibration& camera = rig_.cameras.front();
  const cv::Size calibrated(camera.width_px, camera.height_px);
  if (calibrated.width > 0) {
    if (!haveSameProportions(image_size_, calibrated) || calibrated.width > image_size_.width) {
      throw InputError(fmt::format(
          "{}: the film has {} x {} px, the rig describes {} x {} px of {}; calibrate in the mode of the "
          "film, "
          "or at a smaller size with the same proportions",
          name_, image_size_.width, image_size_.height, calibrated.width, calibrated.height, camera.name));
    }
    if (calibrated != image_size_) {
      diagnostics_->report(
          Severity::Notice, "video_scaled",
          fmt::format("{}: images of {} x {} px are scaled to {} x {} px of the rig", name_,
                      image_size_.width, image_size_.height, calibrated.width, calibrated.height));
      image_size_ = calibrated;
    }
  }
  std::vector<Time> first;
  if (stamps_) {
    first = stamps_->first();
  } else {
    FilmFrameTimes times(chapters_.front().file, chapters_.front().images.index);
    while (first.size() < kStampsForRate) {
      const std::optional<Duration> time = times.next();
      if (!time) break;
      first.push_back(Time() + *time);
    }
  }
  camera.rate_hz = settleRate(name_ + " images", first, camera.rate_hz, diagnostics_);
  if (!(camera.rate_hz > 0.0)) camera.rate_hz = CameraCalibration().rate_hz;
}

void VideoSource::settleImu(const VideoOptions& options) {
  if (!options.needs_calibration && !rig_file_.sections.contains("imu0")) rig_.imu.rate_hz = 0.0;
  const std::vector<Time> first = sensors_ ? sensors_->firstImuStamps() : std::vector<Time>();
  rig_.imu.rate_hz = settleRate(name_ + " imu0", first, rig_.imu.rate_hz, diagnostics_);
  if (!(rig_.imu.rate_hz > 0.0)) rig_.imu.rate_hz = ImuCalibration().rate_hz;
}

void VideoSource::settleMagnetometer(const VideoOptions& options) {
  if (!sensors_ || !sensors_->hasMagnetometer()) {
    rig_.magnetometer.reset();
    return;
  }
  if (!rig_.magnetometer && !options.needs_calibration) {
    rig_.magnetometer.emplace();
    rig_.magnetometer->rate_hz = 0.0;
  }
  if (!rig_.magnetometer) return;
  double& rate_hz = rig_.magnetometer->rate_hz;
  rate_hz = settleRate(name_ + " mag0", sensors_->firstMagnetometerStamps(), rate_hz, diagnostics_);
  if (!(rate_hz > 0.0)) rate_hz = MagnetometerCalibration().rate_hz;
}

std::optional<ImuSample> VideoSource::nextRecordedImu() {
  return sensors_ ? sensors_->nextImu() : std::nullopt;
}

std::optional<MagnetometerSample> VideoSource::nextMagnetometer() {
  return rig_.magnetometer && sensors_ ? sensors_->nextMagnetometer() : std::nullopt;
}

std::optional<Duration> VideoSource::nextInChapter() {
  while (chapter_ < chapters_.size()) {
    const FilmChapter& chapter = chapters_[chapter_];
    if (!times_) {
      times_.emplace(chapter.file, chapter.images.index);
      decoder_ = std::make_shared<FilmDecoder>(chapter.file, chapter.images.index, image_size_);
    }
    if (const std::optional<Duration> time = times_->next()) return time;
    if (times_->packets() < chapter.images.stated_count) {
      diagnostics_->report(
          Severity::Serious, "video_cut_off",
          fmt::format("{}: its index lists {} images, {} are in the file; copy it again",
                      chapter.file.string(), chapter.images.stated_count, times_->packets()));
    }
    times_.reset();
    ++chapter_;
  }
  return std::nullopt;
}

std::optional<Time> VideoSource::stampOf(Duration time) {
  if (!stamps_) return Time() + chapters_[chapter_].start + time;
  std::optional<Time> stamp = stamps_->next();
  if (!stamp) {
    diagnostics_->report(
        Severity::Serious, "video_stamps",
        fmt::format("{}: the film has more images than the {} stamps of its table; the images "
                    "after them are left out",
                    name_, stamps_->count()));
  }
  return stamp;
}

std::optional<PendingImage> VideoSource::nextImage(size_t camera) {
  if (camera != 0) return std::nullopt;
  const std::optional<Duration> time = nextInChapter();
  if (!time) return std::nullopt;
  const std::optional<Time> stamp = stampOf(*time);
  if (!stamp) return std::nullopt;
  decoder_->announce(*time);
  const auto load = [decoder = decoder_, time = *time] { return decoder->load(time); };
  const auto stored = [load] {
    LoadedImage image = load();
    return StoredImage{{}, std::move(image.image), std::move(image.problem)};
  };
  const std::string name = fmt::format("{} at {:.4f} s", chapters_[chapter_].file.string(), time->seconds());
  return PendingImage{*stamp, name, load, stored};
}

}  // namespace lodeline

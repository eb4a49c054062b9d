#include "simulation/recording/image_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "lodeline/diagnostics.h"
#include "simulation/recording/recording_files.h"
#include "simulation/sensors/sensor_clock.h"

namespace lodeline {
namespace {

// Delay of the first image after the first IMU reading, so that it has readings before it.
constexpr double kFirstImage_s = 0.1;

std::string fileName(const ScheduledImage& image) { return fmt::format("{}.png", image.stamp.nanoseconds()); }

std::filesystem::path imagePath(const std::filesystem::path& folder, const ScheduledImage& image) {
  return folder / "mav0" / fmt::format("cam{}", image.camera) / "data" / fileName(image);
}

void writeImage(const cv::Mat& image, const std::filesystem::path& path) {
  std::vector<uchar> encoded;
  cv::imencode(".png", image, encoded, {cv::IMWRITE_PNG_COMPRESSION, 1});
  std::filesystem::path unfinished = path;
  unfinished += ".part";
  {
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(encoded.data()), static_cast<std::streamsize>(encoded.size()));
    if (!file.flush()) {
      throw InputError(fmt::format("{}: could not be written; is the disk full?", path.string()));
    }
  }
  std::filesystem::rename(unfinished, path);
}

}  // namespace

std::vector<ScheduledImage> scheduleImages(const Dive& dive) {
  SensorClock clock(dive.errors.camera_clock, dive.start, dive.scenario.seed, "camera");
  Random drops(dive.scenario.seed, "camera/drops");
  std::vector<ScheduledImage> images;
  for (int i = 0;; ++i) {
    const double t = kFirstImage_s + i / dive.scenario.rig.camera_rate_hz;
    if (t > dive.motion.duration_s()) return images;
    const Time stamp = clock.stamp(t);
    for (int camera = 0; camera < dive.scenario.rig.cameras; ++camera) {
      if (!drops.chance(dive.errors.dropped_image_share)) images.push_back({camera, t, stamp});
    }
  }
}

void recordImageLists(const Dive& dive, const std::vector<ScheduledImage>& images,
                      const std::filesystem::path& folder) {
  for (int camera = 0; camera < dive.scenario.rig.cameras; ++camera) {
    RecordingFile list(folder / "mav0" / fmt::format("cam{}", camera) / "data.csv");
    list.write(kImageColumns);
    for (const ScheduledImage& image : images) {
      if (image.camera == camera)
        list.write(fmt::format("{},{}\n", image.stamp.nanoseconds(), fileName(image)));
    }
    list.close();
    std::filesystem::create_directories(folder / "mav0" / fmt::format("cam{}", camera) / "data");
  }
}

ImageProgress recordImages(const ImageRenderer& renderer, const Dive& dive,
                           const std::vector<ScheduledImage>& images, const std::filesystem::path& folder,
                           const ImageRecordingOptions& options) {
  ImageProgress progress;
  progress.total = images.size();
  std::vector<ScheduledImage> missing;
  for (const ScheduledImage& image : images) {
    if (!std::filesystem::exists(imagePath(folder, image))) missing.push_back(image);
  }
  progress.done = images.size() - missing.size();

  // Before the dive, the rig has its initial pose.
  const WorldFromBodyAt motion = [&dive](double time_s) {
    return dive.motion.at(std::max(time_s, 0.0)).world_from_body;
  };
  std::atomic<size_t> next = 0;
  std::atomic<bool> stopped = false;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    try {
      for (size_t i = next++; i < missing.size() && !stopped; i = next++) {
        writeImage(renderer.render(missing[i].camera, motion, missing[i].middle_s),
                   imagePath(folder, missing[i]));
        const std::lock_guard lock(mutex);
        ++progress.done;
        ++progress.rendered;
        if (options.progress) options.progress(progress);
        if (options.stop && options.stop()) stopped = true;
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      stopped = true;
    }
  };
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const unsigned count = options.threads > 0 ? static_cast<unsigned>(options.threads) : cores;
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < count; ++i) threads.emplace_back(work);
  threads.clear();
  if (failure) std::rethrow_exception(failure);
  return progress;
}

}  // namespace lodeline

#include "lodeline/rig_calibration/record/board_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <thread>

namespace lodeline {
namespace {

constexpr int64_t kSameMoment_ns = 2'000'000;

/// One image with what was found in it.
struct SearchedImage {
  PendingImage image;
  cv::Size size;
  std::string problem;
  std::vector<BoardCorner> corners;
};

std::vector<SearchedImage> listImages(MeasurementSource* source, size_t camera,
                                      const BoardRecordOptions& options) {
  std::vector<SearchedImage> images;
  std::optional<Time> first, last;
  // Half a nominal period of slack, so that jitter drops no image.
  const double least_step_s = 0.75 / options.most_rate_hz;
  while (std::optional<PendingImage> image = source->nextImage(camera)) {
    if (!first) first = image->time;
    const double since_start_s = (image->time - *first).seconds();
    if (since_start_s < options.from_s || (options.to_s && since_start_s > *options.to_s)) continue;
    if (last && (image->time - *last).seconds() < least_step_s) continue;
    last = image->time;
    images.push_back({std::move(*image), {}, {}, {}});
  }
  return images;
}

void searchImages(const CalibrationBoard& board, const std::function<void(size_t)>& progress,
                  std::vector<SearchedImage>* images) {
  std::atomic<size_t> next = 0;
  const auto work = [&](bool tells) {
    const BoardDetector detector(board);
    for (size_t i = next++; i < images->size(); i = next++) {
      SearchedImage& searched = (*images)[i];
      const LoadedImage loaded = searched.image.load();
      searched.problem = loaded.problem;
      if (loaded.image.empty()) continue;
      searched.size = loaded.image.size();
      searched.corners = detector.detect(loaded.image);
      if (tells && progress) progress(i + 1);
    }
  };
  std::vector<std::jthread> threads;
  const unsigned count = std::clamp(std::thread::hardware_concurrency(), 1u, 8u);
  for (unsigned i = 1; i < count; ++i) threads.emplace_back(work, false);
  work(true);
}

void settleSize(const std::vector<SearchedImage>& images, CameraCalibration* camera) {
  for (const SearchedImage& searched : images) {
    if (searched.size.area() == 0) continue;
    const cv::Size stated(camera->width_px, camera->height_px);
    if (camera->fx_px > 0.0 && stated.area() > 0 && stated != searched.size) {
      throw InputError(
          fmt::format("{}: the calibration states images of {} x {} px, the recording has {} x {}",
                      camera->name, stated.width, stated.height, searched.size.width, searched.size.height));
    }
    camera->width_px = searched.size.width;
    camera->height_px = searched.size.height;
    return;
  }
}

/// Puts a view into the frame of its moment.
void addView(Time stamp, BoardView view, std::map<Time, BoardFrame>* frames) {
  const Duration slack = Duration::fromNanoseconds(kSameMoment_ns);
  for (auto near = frames->lower_bound(stamp - slack); near != frames->end(); ++near) {
    if (near->first > stamp + slack) break;
    if (near->second.viewOf(view.camera)) continue;
    near->second.views.push_back(std::move(view));
    return;
  }
  BoardFrame frame{stamp, {}};
  frame.views.push_back(std::move(view));
  frames->insert_or_assign(stamp, std::move(frame));
}

void refuseWithoutBoard(const BoardRecord& record, size_t views) {
  if (views > 0) return;
  size_t images = 0;
  for (const size_t searched : record.searched) images += searched;
  if (images == 0)
    throw InputError("the recording has no images in the time to use; look at --from and --to");
  throw EstimationError(fmt::format(
      "no board found in {} images. Looked for {}, at least {} of them in an image. Check the file "
      "of the board, focus and light, and that the tags are not printed as a mirror image",
      images, boardWords(record.board), BoardDetector::kLeastTags));
}

}  // namespace

BoardRecord readBoardRecord(MeasurementSource* source, const CalibrationBoard& board,
                            const BoardRecordOptions& options, Diagnostics* diagnostics) {
  BoardRecord record;
  record.board = board;
  record.rig = source->rig();
  std::map<Time, BoardFrame> frames;
  size_t views = 0, before = 0;
  for (size_t camera = 0; camera < record.rig.cameras.size(); ++camera) {
    CameraCalibration& calibration = record.rig.cameras[camera];
    std::vector<SearchedImage> images = listImages(source, camera, options);
    searchImages(
        board,
        [&](size_t done) {
          if (options.progress) options.progress(before + done);
        },
        &images);
    before += images.size();
    settleSize(images, &calibration);
    record.has_lens.push_back(calibration.fx_px > 0.0);
    record.searched.push_back(images.size());
    for (SearchedImage& searched : images) {
      if (!searched.problem.empty())
        diagnostics->report(Severity::Warning, "image_unreadable", searched.problem);
      if (searched.corners.empty()) continue;
      addView(searched.image.time, {camera, std::move(searched.corners)}, &frames);
      ++views;
    }
  }
  refuseWithoutBoard(record, views);
  for (auto& [stamp, frame] : frames) record.frames.push_back(std::move(frame));
  while (std::optional<ImuSample> sample = source->nextImu()) {
    // A reading that does not follow the last one in time has no place in an integral.
    if (!record.imu.empty() && sample->time <= record.imu.back().time) continue;
    if (!sample->angular_velocity_B.allFinite() || !sample->specific_force_B.allFinite()) continue;
    record.imu.push_back(*sample);
  }
  return record;
}

}  // namespace lodeline

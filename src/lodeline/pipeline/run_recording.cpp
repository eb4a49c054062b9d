#include "lodeline/pipeline/run_recording.h"

#include <fmt/core.h>
#include <malloc.h>

#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "lodeline/api/recording_check.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/synchronizer/thinned_source.h"
#include "lodeline/output/live/live_view.h"
#include "lodeline/pipeline/output_choice.h"
#include "lodeline/pipeline/run_pace.h"
#include "lodeline/pipeline/run_progress.h"
#include "lodeline/pipeline/stop_request.h"

namespace lodeline {
namespace {

/// Processes all packets with the estimator until the recording or the user ends the run.
void process(RecordingRun* run, const RunRequest& request, const StopRequest& stop) {
  RunSession* const session = &run->session();
  std::optional<LiveView> live;
  if (request.live_port) {
    const std::string name = std::filesystem::absolute(request.output).filename().string();
    live.emplace(request.live_address, *request.live_port, name, request.data, run->rig());
    if (!request.quiet) fmt::print(stderr, "live at {}\n", live->url());
  }
  const auto is_stopped = [&stop] { return stop.made(); };
  if (live && request.live_wait) {
    if (!request.quiet) fmt::print(stderr, "waiting for a browser\n");
    waitUntil([&live] { return live->isWatched(); }, is_stopped);
  }
  RunPace pace(request.rate, is_stopped);
  RunProgress progress(request.quiet, run->length_s());
  while (session->fetch() && !stop.made()) {
    pace.await(session->fetchedTime());
    session->process();
    if (live) {
      live->show(session->packet(), session->estimate(), session->summary(), session->odometry().frontEnd(),
                 session->landmarks(), session->mapFromOdom());
    }
    progress.show(session->summary(), run->shareRead());
  }
  progress.end();
}

/// Opens the recording a second time, to check its first seconds before the run.
void checkRequested(const RunRequest& request, RunSettings* options, Diagnostics* diagnostics) {
  const SourceFactory open = [&](Diagnostics* unheard) -> std::unique_ptr<MeasurementSource> {
    return everyNthImage(openRecording(request.data, options->source, request.bag, unheard),
                         options->image_step);
  };
  checkRecording(open, request.data, options, diagnostics);
}

/// Configures the heap of glibc. By default it gives every thread its own heap. Each image is decoded by a
/// short-lived thread. Memory freed in one heap is not available in another, so memory would depend on thread
/// scheduling. By default it also returns large blocks at once, and every frame's images and matrices would
/// be mapped again, page by page. That takes a tenth of the time of a start with one camera, and saves 4 MB.
void arrangeHeap() {
#ifdef __GLIBC__
  constexpr int kGreatestMappingBytes = 32 << 20;  // the largest value that glibc accepts
  constexpr int kKeptBytes = 2 * kGreatestMappingBytes;
  mallopt(M_ARENA_MAX, 1);
  mallopt(M_MMAP_THRESHOLD, kGreatestMappingBytes);
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
#endif
}

}  // namespace

void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options) {
  bindRunSettings(settings, options);
  if (!request.config.empty()) settings->load(request.config);
  for (const std::string& override : request.overrides) {
    const size_t equals = override.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--set {}: expected KEY=VALUE", override));
    settings->set(override.substr(0, equals), override.substr(equals + 1));
  }
  if (!request.magnetometer.empty()) settings->set("magnetometer.model", request.magnetometer);
  if (!request.site.empty()) settings->set("heading.site", "[" + request.site + "]");
  if (!request.date.empty()) settings->set("heading.date", request.date);
  if (!request.magnetometer_calibration.empty()) {
    options->magnetometer_calibration = request.magnetometer_calibration;
  }
  options->odometry.estimator.magnetometer.site_field_W = siteField_W(*options);
}

RecordingRun::RecordingRun(const RunRequest& request, Diagnostics* diagnostics) {
  // One thread for image operations, so that all machines give the same bytes and processor times per frame
  // are comparable.
  cv::setNumThreads(1);
  arrangeHeap();
  if (!request.output.empty()) {
    refuseRecordingAsOutput(request.data, request.output);
    if (!request.overwrite) refuseToReplaceRun(request.output);
  }
  applyRequest(request, &settings_, &options_);
  source_ = everyNthImage(openRecording(request.data, options_.source, request.bag, diagnostics),
                          options_.image_step);
  checkRequested(request, &options_, diagnostics);
  session_.emplace(request, settings_, options_, source_.get(), diagnostics);
}

RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics) {
  const StopRequest stop;  // also while the first seconds are checked
  RecordingRun run(request, diagnostics);
  process(&run, request, stop);
  return run.session().finish();
}

}  // namespace lodeline

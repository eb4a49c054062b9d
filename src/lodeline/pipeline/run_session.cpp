#include "lodeline/pipeline/run_session.h"

#include <filesystem>

#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/pipeline/process_usage.h"
#include "lodeline/pipeline/refine_run.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

AttitudeFilterOptions attitudeOptions(const RunSettings& options) {
  AttitudeFilterOptions attitude;
  attitude.site_field_W = options.odometry.estimator.magnetometer.site_field_W;
  return attitude;
}

RunDescription describe(const RunRequest& request, const RunSettings& options, const Rig& rig) {
  RunDescription description;
  description.version = LODELINE_VERSION;
  description.data = request.data;
  description.config = request.config;
  description.overrides = request.overrides;
  for (const CameraCalibration& camera : rig.cameras) description.cameras.push_back(camera.name);
  description.camera_rate_hz = rig.cameras.front().rate_hz;
  description.imu_rate_hz = rig.imu.rate_hz;
  description.camera_axis_B = rig.cameras.front().body_from_camera.rotation * Vec3::UnitZ();
  description.magnetometer = rig.magnetometer;
  description.site_field_W = options.odometry.estimator.magnetometer.site_field_W;
  if (rig.magnetometer) description.other_sensors.push_back("magnetometer");
  if (rig.pressure) description.other_sensors.push_back("pressure");
  if (rig.sonar) description.other_sensors.push_back("sonar");
  if (rig.altimeter) description.other_sensors.push_back("altimeter");
  if (rig.dvl) description.other_sensors.push_back("DVL");
  if (rig.currents) description.other_sensors.push_back("currents");
  description.observation_sigma_px = options.odometry.front_end.sigma_px;
  return description;
}

/// Sizes, names and positions of tags that the settings state.
void addTags(const RunSettings& options, RunMappingRequest* mapping, Diagnostics* diagnostics) {
  mapping->tags.size_m = options.tag_size_m;
  if (!options.tags_control.empty()) {
    ControlReadOptions read;
    if (options.site.size() == 3)
      read.site = GeodeticPosition{options.site[0], options.site[1], options.site[2]};
    const ControlSet control = readControl(options.tags_control, read, diagnostics);
    mapping->tags.sizes_m = control.tag_sizes_m;
    for (const ControlPoint& point : control.points) {
      if (point.tag) mapping->mapping.tags.add(point);
    }
    if (mapping->mapping.tags.points.empty())
      throw InputError(options.tags_control + ": tags.control names a file without tags");
    if (mapping->tags.sizes_m.empty() && options.tag_size_m == 0.0) {
      throw UsageError(options.tags_control +
                       ": no size of a tag is known; state tags.size_m, or a column 'size [m]' in the file");
    }
  }
  mapping->tags.check();
}

RunMappingRequest mappingRequest(const RunRequest& request, const RunSettings& options,
                                 Diagnostics* diagnostics) {
  RunMappingRequest mapping;
  addTags(options, &mapping, diagnostics);
  mapping.folder = request.output;
  mapping.earlier_map = request.map;
  mapping.mapping.start = request.map_start;
  mapping.north = wantedReference(options.odometry.estimator.magnetometer);
  mapping.name = std::filesystem::absolute(request.output).filename().string();
  mapping.recording = request.data;
  return mapping;
}

void writeSettings(const std::filesystem::path& folder, const Settings& settings) {
  std::ofstream config = openOutput(folder / "config.yaml");
  settings.write(config);
  closeOutput(folder / "config.yaml", &config);
}

}  // namespace

RunSession::RunSession(const RunRequest& request, const Settings& settings, const RunSettings& options,
                       RecordedSource* source, Diagnostics* diagnostics)
    : folder_(request.output),
      quiet_(request.quiet),
      diagnostics_(diagnostics),
      loop_(options, source, diagnostics),
      attitude_(source->rig(), attitudeOptions(options), &unheard_),
      summary_(describe(request, options, source->rig())) {
  if (!folder_.empty()) {
    // Before anything is written, because it reads files that the settings name.
    const RunMappingRequest mapping = mappingRequest(request, options, diagnostics);
    createOutputFolder(folder_);
    lock_.emplace(folder_);
    removeRefinedFiles(folder_);
    if (request.refine_interval_s) loop_.record(*request.refine_interval_s);
    writeSettings(folder_, settings);
    output_.emplace(folder_, loop_.odometry().estimator(),
                    RunOutputOptions{request.draw_tracks_s, request.sample_pictures});
    if (options.loops || !request.map.empty()) mapping_.emplace(mapping, source->rig(), diagnostics);
  }
  start_ = Clock::now();
  start_processor_s_ = ProcessUsage::now().processor_s;
}

void RunSession::process() {
  loop_.process();
  const FramePacket& packet = loop_.packet();
  const FrameEstimate& estimate = loop_.estimate();
  const std::optional<AttitudeEstimate>& attitude = attitude_.add(packet);
  landmarks_ =
      output_ ? output_->write(packet, loop_.hasNewStamp() ? &estimate : nullptr, attitude, &loop_.odometry())
              : loop_.odometry().estimator().takeMapPoints();
  if (mapping_) {
    const std::optional<Time> stamp = loop_.hasNewStamp() ? std::optional(estimate.time) : std::nullopt;
    if (mapping_->add(packet, estimate, stamp, loop_.odometry()) && loop_.log()) loop_.keepNewest();
  }
  summary_.add(estimate);
  for (const cv::Mat& image : packet.images) summary_.images += image.empty() ? 0 : 1;
  summary_.wall_s = std::chrono::duration<double>(Clock::now() - start_).count();
}

RunSummary RunSession::finish() {
  loop_.finish();
  const PacketOdometry& odometry = loop_.odometry();
  if (output_)
    summary_.map_points = output_->finish(odometry, summary_.last().sensors.of<MagnetometerEstimate>());
  if (output_) summary_.pictures_s = output_->picturesSeconds();
  if (mapping_) summary_.mapping = mapping_->finish(summary_.last().sensors.of<MagnetometerEstimate>());
  output_.reset();  // closes files that are read next
  summary_.interrupted = loop_.isPending();
  if (!summary_.interrupted) summary_.recorded_images = loop_.synchronizer().recordedImages();
  summary_.front_end_s = odometry.times().front_end_s;
  summary_.estimator_s = odometry.times().estimator_s;
  ProcessUsage usage = ProcessUsage::now();
  summary_.process_s = usage.processor_s - start_processor_s_;
  if (loop_.log()) {
    summary_.refinement =
        refineRun(odometry.estimator(), *loop_.log(), mapping_ ? mapping_->closures() : LoopClosures{},
                  folder_, loop_.resultStamps(), quiet_, diagnostics_);
    usage = ProcessUsage::now();
  }
  summary_.peak_memory_MB = usage.peak_memory_MB;
  summary_.reportBlindStretches(diagnostics_);
  if (!folder_.empty())
    writeOutput(std::filesystem::path(folder_) / "run.json", summary_.json(*diagnostics_));
  return summary_;
}

}  // namespace lodeline

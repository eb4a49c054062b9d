#include <fmt/format.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <functional>
#include <limits>
#include <mutex>

#include "lodeline/io/dives/depth_profile.h"
#include "lodeline/io/logs/open_sensor_log.h"
#include "lodeline/output/files/run_table.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/survey.h"
#include "python/src/arrays.h"
#include "python/src/bag_arguments.h"
#include "python/src/bindings.h"

namespace lodeline::python {
namespace {

namespace fs = std::filesystem;

/// A recording that is opened anew for each stream, so that every stream starts at its beginning.
class Recording {
 public:
  Recording(fs::path data, BagArguments bag, const std::optional<std::vector<int>>& cameras)
      : data_(std::move(data)), bag_(std::move(bag)) {
    options_.needs_cameras = options_.needs_imu = options_.needs_calibration = false;
    if (cameras) options_.camera_indices = *cameras;
    const std::unique_ptr<RecordedSource> source = open(true);
    rig_ = {source->rig(), source->imuCorrection()};
  }

  std::unique_ptr<RecordedSource> open(bool with_cameras) {
    EurocOptions options = options_;
    options.with_cameras = with_cameras;
    return openRecording(data_, options, bag_, &diagnostics_);
  }

  /// All readings of one stream.
  template <typename Sample>
  std::vector<Sample> read(const std::function<std::optional<Sample>(RecordedSource*)>& next) {
    return alone([&] {
      const std::unique_ptr<RecordedSource> source = open(false);
      std::vector<Sample> samples;
      while (std::optional<Sample> sample = next(source.get())) samples.push_back(*sample);
      return samples;
    });
  }

  /// The result of `work`, which uses the diagnostics, while other threads of Python go on.
  template <typename Work>
  auto alone(const Work& work) {
    const py::gil_scoped_release released;
    const std::lock_guard lock(mutex_);
    return work();
  }

  const fs::path& data() const { return data_; }
  const DescribedRig& rig() const { return rig_; }
  Diagnostics& diagnostics() { return diagnostics_; }  ///< to be used in alone()

 private:
  fs::path data_;
  BagArguments bag_;
  EurocOptions options_;
  DescribedRig rig_;
  std::mutex mutex_;  ///< for the diagnostics
  Diagnostics diagnostics_;
};

/// The images of one camera, decoded one by one.
class Images {
 public:
  Images(Recording* recording, size_t camera)
      : recording_(recording),
        source_(recording->alone([&] { return recording->open(true); })),
        camera_(camera) {}

  py::tuple next() {
    std::optional<PendingImage> image;
    LoadedImage loaded;
    recording_->alone([&] {
      image = source_->nextImage(camera_);
      if (image) loaded = image->load();
      if (image && loaded.image.empty())
        recording_->diagnostics().report(Severity::Warning, "image_unreadable", loaded.problem);
    });
    if (!image) throw py::stop_iteration();
    if (loaded.image.empty()) return py::make_tuple(image->time.nanoseconds(), py::none());
    return py::make_tuple(image->time.nanoseconds(), arrayOf(loaded.image));
  }

 private:
  /// The pixels without a copy; the array keeps the image alive.
  static py::array_t<uint8_t> arrayOf(const cv::Mat& image) {
    auto* kept = new cv::Mat(image);
    const py::capsule owner(kept, [](void* pointer) { delete static_cast<cv::Mat*>(pointer); });
    return py::array_t<uint8_t>({image.rows, image.cols},
                                {static_cast<py::ssize_t>(image.step[0]), py::ssize_t{1}}, image.data, owner);
  }

  Recording* recording_;
  std::unique_ptr<RecordedSource> source_;
  size_t camera_;
};

py::tuple imuOf(Recording& recording, bool corrected) {
  const auto samples = recording.read<ImuSample>(
      [=](RecordedSource* source) { return corrected ? source->nextImu() : source->nextRecordedImu(); });
  return py::make_tuple(timeColumn(samples, [](const ImuSample& s) { return s.time; }),
                        stack(samples, [](const ImuSample& s) { return s.angular_velocity_B; }),
                        stack(samples, [](const ImuSample& s) { return s.specific_force_B; }));
}

py::tuple magnetometerOf(Recording& recording) {
  const auto samples =
      recording.read<MagnetometerSample>([](RecordedSource* source) { return source->nextMagnetometer(); });
  return py::make_tuple(timeColumn(samples, [](const MagnetometerSample& s) { return s.time; }),
                        stack(samples, [](const MagnetometerSample& s) { return s.field_M; }));
}

py::tuple depthOf(Recording& recording) {
  const auto samples =
      recording.read<DepthSample>([](RecordedSource* source) { return source->nextDepth(); });
  return py::make_tuple(timeColumn(samples, [](const DepthSample& s) { return s.time; }),
                        column<double>(samples, [](const DepthSample& s) { return s.depth_m; }));
}

py::tuple sonarOf(Recording& recording) {
  const auto samples =
      recording.read<SonarSample>([](RecordedSource* source) { return source->nextSonar(); });
  return py::make_tuple(timeColumn(samples, [](const SonarSample& s) { return s.time; }),
                        column<double>(samples, [](const SonarSample& s) { return s.range_m; }),
                        column<double>(samples, [](const SonarSample& s) { return s.angle_rad; }));
}

py::tuple altimeterOf(Recording& recording) {
  const auto samples =
      recording.read<AltimeterSample>([](RecordedSource* source) { return source->nextAltimeter(); });
  return py::make_tuple(timeColumn(samples, [](const AltimeterSample& s) { return s.time; }),
                        column<double>(samples, [](const AltimeterSample& s) { return s.range_m; }));
}

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<DvlSample> pingsOf(Recording& recording) {
  return recording.read<DvlSample>([](RecordedSource* source) { return source->nextDvl(); });
}

py::tuple dvlOf(Recording& recording) {
  const std::vector<DvlSample> pings = pingsOf(recording);
  return py::make_tuple(
      timeColumn(pings, [](const DvlSample& s) { return s.time; }),
      stack(pings, [](const DvlSample& s) { return s.velocity_D.value_or(Vec3::Constant(kMissing)); }),
      column<double>(pings, [](const DvlSample& s) { return s.velocity_sigma_m_per_s.value_or(kMissing); }),
      column<bool>(pings, [](const DvlSample& s) { return s.track == DvlTrack::Water; }));
}

py::tuple dvlBeamsOf(Recording& recording) {
  struct BeamReading {
    Time time;
    DvlBeam beam;
  };
  std::vector<BeamReading> readings;
  for (const DvlSample& ping : pingsOf(recording)) {
    for (const DvlBeam& beam : ping.beams) readings.push_back({ping.time, beam});
  }
  const auto value = [&](std::optional<double> DvlBeam::*member) {
    return column<double>(readings,
                          [=](const BeamReading& r) { return (r.beam.*member).value_or(kMissing); });
  };
  return py::make_tuple(timeColumn(readings, [](const BeamReading& r) { return r.time; }),
                        column<int32_t>(readings, [](const BeamReading& r) { return r.beam.index; }),
                        value(&DvlBeam::velocity_m_per_s), value(&DvlBeam::range_m));
}

/// The times, and by the names of the channels their currents.
py::tuple currentsOf(Recording& recording) {
  const auto samples =
      recording.read<CurrentSample>([](RecordedSource* source) { return source->nextCurrents(); });
  py::dict channels;
  const std::optional<CurrentCalibration>& currents = recording.rig().rig.currents;
  for (size_t i = 0; currents && i < currents->channels.size(); ++i) {
    channels[py::str(currents->channels[i])] =
        column<double>(samples, [=](const CurrentSample& s) { return s.currents_A[i]; });
  }
  return py::make_tuple(timeColumn(samples, [](const CurrentSample& s) { return s.time; }), channels);
}

Images imagesOf(Recording& recording, size_t camera) {
  const size_t count = recording.rig().rig.cameras.size();
  if (camera >= count) throw py::index_error(fmt::format("camera {}: the recording has {}", camera, count));
  return Images(&recording, camera);
}

/// Readings of a sensor log; NaN at times without a reading, None for sensors that it does not have.
py::dict readReadings(const fs::path& file) {
  Diagnostics diagnostics;
  std::vector<LogReading> readings;
  LogSensors sensors;
  withoutGil([&] {
    const std::unique_ptr<SensorLog> log = openSensorLog(file, {}, &diagnostics);
    for (LogReading reading; log->next(&reading);) readings.push_back(reading);
    sensors = log->sensors();
  });
  warn(diagnostics);
  const auto values = [&](bool has, std::optional<Vec3> LogReading::*value) -> py::object {
    if (!has) return py::none();
    const Vec3 missing = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    return stack(readings, [&](const LogReading& r) { return (r.*value).value_or(missing); });
  };
  py::dict result;
  result["times_ns"] = timeColumn(readings, [](const LogReading& r) { return r.time; });
  result["angular_velocity"] = values(sensors.has_gyroscope, &LogReading::angular_velocity);
  result["specific_force"] = values(sensors.has_accelerometer, &LogReading::specific_force);
  result["field_T"] = values(sensors.has_magnetometer, &LogReading::field);
  return result;
}

py::dict readRunStates(const fs::path& folder) {
  Diagnostics diagnostics;
  const RunTable table = withoutGil([&] { return readRunTable(folder / "states.csv", &diagnostics); });
  warn(diagnostics);
  py::dict states;
  states["times_ns"] = column<int64_t>(table.stamp_ns, [](int64_t stamp) { return stamp; });
  for (const auto& [name, numbers] : table.numbers)
    states[py::str(name)] = column<double>(numbers, [](double number) { return number; });
  for (const auto& [name, words] : table.words) states[py::str(name)] = words;
  return states;
}

void bindRunFolder(py::module_& module) {
  using Type = const RunFolder&;
  py::class_<RunFolder>(module, "RunFolder", "The folder of a finished run; N poses, M landmarks.")
      .def_property_readonly("folder", [](Type r) { return r.folder; })
      .def_readonly("trajectory", &RunFolder::trajectory, "refined where the folder has such poses")
      .def_property_readonly(
          "position_covariance_times_ns",
          [](Type r) {
            return timeColumn(r.uncertainties, [](const PositionUncertainty& u) { return u.time; });
          },
          "(N) int64, ns")
      .def_property_readonly(
          "position_covariances",
          [](Type r) {
            return stack(r.uncertainties, [](const PositionUncertainty& u) { return u.covariance; });
          },
          "(N, 3, 3), m^2, world axes, relative to the first pose")
      .def_property_readonly(
          "landmarks",
          [](Type r) { return stack(r.landmarks, [](const MapLandmark& l) { return l.position; }); },
          "(M, 3), m")
      .def_property_readonly(
          "landmark_observations",
          [](Type r) {
            return column<int32_t>(r.landmarks, [](const MapLandmark& l) { return l.observations; });
          },
          "(M) int32")
      .def_property_readonly(
          "summary",
          [](Type r) {
            return fromJson(py::cast(r.folder / "run.json").attr("read_text")().cast<std::string>());
          },
          "run.json as a dict")
      .def(
          "states", [](Type r) { return readRunStates(r.folder); },
          "states.csv: by the names of its columns, arrays (N) or lists of str; times_ns (N) int64.\n"
          "docs/reference/output-files.md lists the columns with their units.");
  module.def(
      "read_run",
      [](const fs::path& folder) {
        Diagnostics diagnostics;
        RunFolder run = withoutGil([&] { return readRunFolder(folder, &diagnostics); });
        warn(diagnostics);
        return run;
      },
      py::arg("folder"), "Reads the folder that run() or `lodeline run` wrote.");
}

}  // namespace

void bindRecording(py::module_& module) {
  py::class_<Recording>(
      module, "Recording",
      "A recording as arrays: a folder with mav0 (EuRoC ASL layout), or a bag of ROS 1 or ROS 2 (.bag, "
      ".db3,\n"
      ".mcap, folder). Every call reads from the start. Sensors without a calibration get the default one.")
      .def(py::init([](const fs::path& data, const std::vector<fs::path>& rig,
                       const std::map<std::string, std::string>& topics, bool received_times,
                       const std::optional<std::vector<int>>& cameras) {
             const BagArguments bag = bagArguments(rig, topics, received_times);
             return withoutGil([&] { return std::make_unique<Recording>(data, bag, cameras); });
           }),
           py::arg("data"), py::kw_only(), py::arg("rig") = std::vector<fs::path>(),
           py::arg("topics") = std::map<std::string, std::string>(), py::arg("received_times") = false,
           py::arg("cameras") = py::none(),
           "rig: files that describe the rig. topics: for a bag, by sensor (cam0, imu0, mag0, ...).\n"
           "received_times: for a bag without stamps in its headers. cameras: numbers N of the camN to use.")
      .def_property_readonly("data", &Recording::data)
      .def_property_readonly("rig", &Recording::rig)
      .def("imu", &imuOf, py::kw_only(), py::arg("corrected") = true,
           "(times_ns (N) int64, angular_velocity (N, 3) rad/s, specific_force (N, 3) m/s^2), body axes.\n"
           "corrected: with scale, misalignment and biases that the calibration states.")
      .def("magnetometer", &magnetometerOf, "(times_ns (N) int64, field (N, 3) T), axes of the magnetometer.")
      .def("depth", &depthOf, "(times_ns (N) int64, depth (N) m), positive down.")
      .def("sonar", &sonarOf, "(times_ns (N) int64, range (N) m, angle (N) rad).")
      .def("altimeter", &altimeterOf, "(times_ns (N) int64, range (N) m).")
      .def("dvl", &dvlOf,
           "(times_ns (N) int64, velocity (N, 3) m/s, sigma (N) m/s, is_water_track (N) bool), axes of the "
           "DVL.\n"
           "NaN without lock, and where the instrument states no sigma.")
      .def("dvl_beams", &dvlBeamsOf,
           "(times_ns (M) int64, beam (M) int32, velocity (M) m/s, range (M) m), one entry for each beam of "
           "a\n"
           "ping; NaN without lock.")
      .def("currents", &currentsOf,
           "(times_ns (N) int64, dict of the channels' currents (N) A by their names).")
      .def("images", &imagesOf, py::arg("camera") = 0, py::keep_alive<0, 1>(),
           "Iterates over (time_ns, image) of a camera by its index; the image is (height, width) uint8, or\n"
           "None where it cannot be decoded, which is a finding.")
      .def_property_readonly(
          "findings", [](Recording& r) { return findingsOf(r.alone([&] { return r.diagnostics(); })); },
          "of what was read so far");
  py::class_<Images>(module, "Images", "Iterator of Recording.images().")
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", &Images::next);
  module.def("read_readings", &readReadings, py::arg("file"),
             "Reads a sensor log (CSV, a folder or zip of a telephone, PX4, ArduPilot): a dict with times_ns "
             "(N) int64,\n"
             "angular_velocity (N, 3) rad/s, specific_force (N, 3) m/s^2 and field_T (N, 3) T; NaN at times "
             "without a\n"
             "reading, None for sensors that it does not have.");
  module.def(
      "read_depth_profiles",
      [](const fs::path& file) {
        Diagnostics diagnostics;
        const auto profiles = withoutGil([&] { return readDepthProfiles(file, &diagnostics); });
        warn(diagnostics);
        py::list dives;
        for (const DepthProfile& profile : profiles) {
          py::dict dive;
          dive["name"] = printable(profile.name);
          dive["dive"] = printable(profile.dive);
          dive["times_s"] = column<double>(profile.readings, [](const DepthReading& r) { return r.time_s; });
          dive["depths_m"] =
              column<double>(profile.readings, [](const DepthReading& r) { return r.depth_m; });
          dives.append(dive);
        }
        return dives;
      },
      py::arg("file"),
      "Reads the log of a dive computer: for each dive a dict with name, dive, times_s (N) s on the clock "
      "of\n"
      "the log, and depths_m (N) m, positive down.");
  bindRunFolder(module);
}

}  // namespace lodeline::python

#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/imu_halves.h"
#include "lodeline/io/tables/units.h"
#include "lodeline/io/video/film_chapter.h"
#include "lodeline/io/video/gpmf/gpmf_payload.h"
#include "lodeline/io/video/gpmf/sample_clock.h"
#include "lodeline/io/video/gpmf/stream_axes.h"
#include "lodeline/io/video/video_sensors.h"

namespace lodeline {

/// The sensors of a GoPro camera from the GPMF tracks of its chapters, in SI units and in the body axes of
/// gpmf::StreamAxes. Each sensor has its own clock (gpmf::SampleClock); the specific force is interpolated to
/// the times of the gyroscope.
///
/// The constructor reads the tracks once for the clocks, and keeps a few numbers of each payload. The
/// readings are read again as a stream.
class GpmfSensors : public VideoSensors {
 public:
  /// Reports damaged payloads as `telemetry_damaged`, lost samples as `telemetry_lost`, axes that nothing
  /// states as `telemetry_axes`. Throws InputError for a unit that is not known. `diagnostics` must outlive
  /// the object.
  GpmfSensors(std::vector<FilmChapter> chapters, Diagnostics* diagnostics);

  bool hasImu() const override { return sensors_.contains("GYRO") && sensors_.contains("ACCL"); }
  bool hasMagnetometer() const override { return sensors_.contains("MAGN"); }
  std::optional<ImuSample> nextImu() override;
  std::optional<MagnetometerSample> nextMagnetometer() override;
  std::vector<Time> firstImuStamps() const override { return firstStamps("GYRO"); }
  std::vector<Time> firstMagnetometerStamps() const override { return firstStamps("MAGN"); }
  const std::vector<VideoStreamFacts>& facts() const override { return facts_; }

 private:
  /// What the payloads state of one stream of one device.
  struct Record {
    gpmf::Stream first;  ///< of the first payload, without its values
    std::vector<gpmf::PayloadSamples> payloads;
    std::optional<uint64_t> counted;
  };
  using Records = std::map<std::pair<double, std::string>, Record>;  ///< by device and key

  /// A sensor whose readings are used.
  struct Sensor {
    gpmf::SampleClock clock;
    gpmf::StreamAxes axes;
    double to_si = 1.0;
    double delay_s = 0.0;

    // Position of the reader.
    size_t chapter = 0;
    std::optional<FilmTrackReader> reader = {};
    size_t payload = 0;  ///< number of the payloads with samples before `stream`
    gpmf::Stream stream = {};
    size_t sample = 0;  ///< the next one in `stream`
  };
  struct Reading {
    Time time;
    Vec3 value_B;
  };

  Records scan();
  void addPayload(const FilmChapter& chapter, const FilmPacket& packet, bool starts_file, Records* records);
  std::optional<gpmf::ClockLine> frameClock(const Records& records) const;
  void addSensor(const std::string& key, Quantity quantity, const char* usual_unit, const Records& records,
                 const std::optional<gpmf::ClockLine>& frame_clock);
  void addFacts(const Records& records, const std::optional<gpmf::ClockLine>& frame_clock);
  bool nextPayload(const std::string& key, Sensor* sensor);
  std::optional<Reading> next(const std::string& key);
  std::vector<Time> firstStamps(const std::string& key) const;

  std::vector<FilmChapter> chapters_;
  Diagnostics* diagnostics_;
  std::optional<double> device_;  ///< the camera
  std::map<std::string, Sensor> sensors_;
  std::vector<VideoStreamFacts> facts_;
  ImuHalves halves_;
};

}  // namespace lodeline

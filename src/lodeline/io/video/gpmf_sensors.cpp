#include "lodeline/io/video/gpmf_sensors.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

/// Streams with one sample for each image. Their stamps (STMP) tie the camera's clock to that of the images.
constexpr std::array kPerImage = {"CORI", "IORI", "SHUT", "ISOE", "WBAL", "WRGB"};
constexpr double kSameCount = 0.02;

constexpr std::array kThreeAxes = {"GYRO", "ACCL", "MAGN"};

}  // namespace

GpmfSensors::GpmfSensors(std::vector<FilmChapter> chapters, Diagnostics* diagnostics)
    : chapters_(std::move(chapters)), diagnostics_(diagnostics) {
  const Records records = scan();
  const std::optional<gpmf::ClockLine> frame_clock = frameClock(records);
  addSensor("GYRO", Quantity::AngularRate, "rad/s", records, frame_clock);
  addSensor("ACCL", Quantity::SpecificForce, "m/s2", records, frame_clock);
  addSensor("MAGN", Quantity::MagneticField, "uT", records, frame_clock);
  addFacts(records, frame_clock);
}

GpmfSensors::Records GpmfSensors::scan() {
  Records records;
  for (const FilmChapter& chapter : chapters_) {
    if (!chapter.telemetry) {
      diagnostics_->report(Severity::Serious, "telemetry_missing",
                           chapter.file.string() + ": has no telemetry track, though another chapter has");
      continue;
    }
    FilmTrackReader reader(chapter.file, chapter.telemetry->index);
    while (const std::optional<FilmPacket> packet = reader.next()) {
      addPayload(chapter, *packet, reader.packets() == 1, &records);
    }
    if (reader.packets() >= chapter.telemetry->stated_count) continue;
    diagnostics_->report(
        Severity::Serious, "video_cut_off",
        fmt::format("{}: its index lists {} payloads of telemetry, {} are in the file; copy it again",
                    chapter.file.string(), chapter.telemetry->stated_count, reader.packets()));
  }
  return records;
}

void GpmfSensors::addPayload(const FilmChapter& chapter, const FilmPacket& packet, bool starts_file,
                             Records* records) {
  gpmf::Payload payload = gpmf::parsePayload(packet.bytes);
  for (const std::string& problem : payload.problems) {
    diagnostics_->report(Severity::Warning, "telemetry_damaged",
                         fmt::format("{}: telemetry at {:.3f} s: {}; left out", chapter.file.string(),
                                     packet.time.seconds(), problem));
  }
  std::set<std::pair<double, std::string>> seen;
  for (gpmf::Stream& stream : payload.streams) {
    if (!seen.insert({stream.device, stream.key}).second) continue;  // nextPayload() takes the first one too
    const bool is_sensor =
        std::find(kThreeAxes.begin(), kThreeAxes.end(), stream.key) != kThreeAxes.end() && stream.axes == 3;
    if (is_sensor && !device_) device_ = stream.device;
    Record& record = (*records)[{stream.device, stream.key}];
    gpmf::PayloadSamples samples;
    samples.time_s = (chapter.start + packet.time).seconds();
    samples.length_s = packet.length.seconds();
    samples.samples = stream.samples;
    samples.total_samples = stream.total_samples;
    if (stream.stamp_us) samples.stamp_s = 1e-6 * static_cast<double>(*stream.stamp_us);
    samples.starts_file = starts_file;
    if (record.payloads.empty()) {
      record.first = stream;
      record.first.values.clear();
    }
    if (stream.total_samples) record.counted = stream.total_samples;
    record.payloads.push_back(samples);
  }
}

std::optional<gpmf::ClockLine> GpmfSensors::frameClock(const Records& records) const {
  const FilmTrack& images = chapters_.front().images;
  int64_t count = 0;
  for (const FilmChapter& chapter : chapters_) count += chapter.images.stated_count;
  if (!device_ || count == 0 || !(images.rate_hz > 0.0)) return std::nullopt;
  for (const char* key : kPerImage) {
    const auto found = records.find({*device_, key});
    if (found == records.end()) continue;
    const std::vector<gpmf::PayloadSamples>& payloads = found->second.payloads;
    const gpmf::SampleClock numbered(payloads);
    const auto samples = static_cast<double>(numbered.received());
    if (std::abs(samples - static_cast<double>(count)) > kSameCount * static_cast<double>(count)) continue;
    std::vector<gpmf::ClockPoint> points;
    for (size_t i = 0; i < payloads.size(); ++i) {
      if (!payloads[i].stamp_s) continue;
      if (!points.empty() && *payloads[i].stamp_s <= points.back().x) return std::nullopt;  // set back
      const double image_s = images.start.seconds() + numbered.firstSample(i) / images.rate_hz;
      points.push_back({*payloads[i].stamp_s, image_s});
    }
    if (const std::optional<gpmf::ClockLine> line = gpmf::fitLine(points)) return line;
  }
  return std::nullopt;
}

void GpmfSensors::addSensor(const std::string& key, Quantity quantity, const char* usual_unit,
                            const Records& records, const std::optional<gpmf::ClockLine>& frame_clock) {
  if (!device_) return;
  const auto found = records.find({*device_, key});
  if (found == records.end() || found->second.first.axes != 3) return;
  const Record& record = found->second;
  const std::string where = fmt::format("{}: telemetry {}", chapters_.front().file.string(), key);
  const std::string unit = record.first.unit.empty() ? usual_unit : record.first.unit;
  const std::optional<double> to_si = unitFactor(quantity, unit);
  if (!to_si) {
    throw InputError(fmt::format("{}: unit '{}' is not known for a {}; known are {}", where, unit,
                                 toString(quantity), knownUnits(quantity)));
  }
  Sensor sensor{gpmf::SampleClock(record.payloads, frame_clock), gpmf::axesOf(record.first), *to_si,
                record.first.delay_s};
  for (const std::string& problem : sensor.clock.problems()) {
    diagnostics_->report(Severity::Warning, "telemetry_lost", fmt::format("{}: {}", where, problem));
  }
  const std::string& problem = sensor.axes.problem;
  if (!problem.empty() || !sensor.axes.is_known) {
    diagnostics_->report(
        Severity::Warning, "telemetry_axes",
        fmt::format(
            "{}: {}; its axes are taken from {}", where,
            problem.empty() ? "neither the stream nor the model of the camera states its axes" : problem,
            sensor.axes.source));
  }
  if (!(sensor.clock.rate_hz() > 0.0)) {
    diagnostics_->report(Severity::Warning, "telemetry_damaged",
                         where + ": too few payloads for a rate; the sensor is left out");
    return;
  }
  sensors_.emplace(key, std::move(sensor));
}

void GpmfSensors::addFacts(const Records& records, const std::optional<gpmf::ClockLine>& frame_clock) {
  for (const auto& [id, record] : records) {
    const bool is_camera = device_ && id.first == *device_;
    const gpmf::SampleClock clock(record.payloads, is_camera ? frame_clock : std::nullopt);
    VideoStreamFacts facts;
    facts.device = record.first.device_name;
    facts.key = id.second;
    facts.name = record.first.name;
    facts.unit = record.first.unit;
    facts.samples = clock.received();
    facts.packets = record.payloads.size();
    if (record.counted) facts.counted = static_cast<int64_t>(*record.counted);
    facts.rate_hz = clock.rate_hz();
    facts.first_s = clock.time_s(0.0);
    facts.last_s = clock.time_s(clock.samples() - 1.0);
    const auto sensor = sensors_.find(id.second);
    if (is_camera && sensor != sensors_.end()) facts.axes = sensor->second.axes.source;
    facts_.push_back(std::move(facts));
  }
}

bool GpmfSensors::nextPayload(const std::string& key, Sensor* sensor) {
  while (sensor->chapter < chapters_.size()) {
    const FilmChapter& chapter = chapters_[sensor->chapter];
    if (chapter.telemetry && !sensor->reader) sensor->reader.emplace(chapter.file, chapter.telemetry->index);
    const std::optional<FilmPacket> packet = sensor->reader ? sensor->reader->next() : std::nullopt;
    if (!packet) {
      sensor->reader.reset();
      ++sensor->chapter;
      continue;
    }
    gpmf::Payload payload = gpmf::parsePayload(packet->bytes);
    for (gpmf::Stream& stream : payload.streams) {
      if (stream.device != *device_ || stream.key != key) continue;
      sensor->stream = std::move(stream);
      sensor->sample = 0;
      ++sensor->payload;
      return true;
    }
  }
  return false;
}

std::optional<GpmfSensors::Reading> GpmfSensors::next(const std::string& key) {
  const auto found = sensors_.find(key);
  if (found == sensors_.end()) return std::nullopt;
  Sensor& sensor = found->second;
  while (true) {
    while (sensor.sample >= sensor.stream.samples || sensor.stream.axes != 3) {
      if (!nextPayload(key, &sensor)) return std::nullopt;
    }
    const double number = sensor.clock.firstSample(sensor.payload - 1) + static_cast<double>(sensor.sample);
    const Vec3 stored(sensor.stream.values.data() + 3 * sensor.sample);
    ++sensor.sample;
    const double time_s = sensor.clock.time_s(number) - sensor.delay_s;
    // Bags hold no times before zero, and no image needs these readings.
    if (!stored.allFinite() || time_s < 0.0) continue;
    return Reading{Time::fromSeconds(time_s), sensor.to_si * (sensor.axes.body_from_stored * stored)};
  }
}

std::optional<ImuSample> GpmfSensors::nextImu() {
  const auto gyroscope = [this]() -> std::optional<ImuSample> {
    const std::optional<Reading> reading = next("GYRO");
    if (!reading) return std::nullopt;
    return ImuSample{reading->time, reading->value_B, Vec3::Zero()};
  };
  const auto accelerometer = [this]() -> std::optional<ImuSample> {
    const std::optional<Reading> reading = next("ACCL");
    if (!reading) return std::nullopt;
    return ImuSample{reading->time, Vec3::Zero(), reading->value_B};
  };
  return hasImu() ? halves_.next(gyroscope, accelerometer) : std::nullopt;
}

std::optional<MagnetometerSample> GpmfSensors::nextMagnetometer() {
  const std::optional<Reading> reading = next("MAGN");
  if (!reading) return std::nullopt;
  return MagnetometerSample{reading->time, reading->value_B};
}

std::vector<Time> GpmfSensors::firstStamps(const std::string& key) const {
  std::vector<Time> stamps;
  const auto found = sensors_.find(key);
  if (found == sensors_.end()) return stamps;
  const gpmf::SampleClock& clock = found->second.clock;
  for (size_t i = 0; i < kStampsForRate && static_cast<double>(i) < clock.samples(); ++i) {
    stamps.push_back(Time::fromSeconds(clock.time_s(static_cast<double>(i))));
  }
  return stamps;
}

}  // namespace lodeline

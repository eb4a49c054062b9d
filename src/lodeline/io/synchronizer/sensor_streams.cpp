#include "lodeline/io/synchronizer/sensor_streams.h"

#include <optional>
#include <type_traits>
#include <utility>

namespace lodeline {
namespace {

// The function of a source that returns the next reading of a kind.
template <typename Sample>
constexpr auto kNext = nullptr;
template <>
constexpr auto kNext<MagnetometerSample> = &MeasurementSource::nextMagnetometer;
template <>
constexpr auto kNext<DepthSample> = &MeasurementSource::nextDepth;
template <>
constexpr auto kNext<SonarSample> = &MeasurementSource::nextSonar;
template <>
constexpr auto kNext<AltimeterSample> = &MeasurementSource::nextAltimeter;
template <>
constexpr auto kNext<DvlSample> = &MeasurementSource::nextDvl;
template <>
constexpr auto kNext<CurrentSample> = &MeasurementSource::nextCurrents;

template <typename Sample>
using CalibrationOf = std::decay_t<decltype(*(Rig().*SensorKind<Sample>::calibration))>;

template <typename Sample>
constexpr bool kHasTimeOffset = requires(const CalibrationOf<Sample>& sensor) {
  sensor.time_offset_to_imu_s;
};

template <typename Sample>
OrderedStream<Sample> streamOf(MeasurementSource* source, const SensorStreams::Expect& expect,
                               Diagnostics* diagnostics) {
  using Kind = SensorKind<Sample>;
  const auto& sensor = source->rig().*Kind::calibration;
  StreamExpectation expected = expect(Kind::finding, Kind::name, sensor ? sensor->rate_hz : 0.0);
  if constexpr (kHasTimeOffset<Sample>) {
    if (sensor) expected.offset_to_imu_clock = Duration::fromSeconds(sensor->time_offset_to_imu_s);
  }
  return {std::move(expected), [source] { return (source->*kNext<Sample>)(); }, diagnostics};
}

}  // namespace

SensorStreams::SensorStreams(MeasurementSource* source, const Expect& expect, Diagnostics* diagnostics)
    : streams_(std::apply(
          [&]<typename... Samples>(const Samples&...) {
            return PerSensorKind<Stream>{{streamOf<Samples>(source, expect, diagnostics), {}}...};
          },
          SensorSamples())) {}

SensorReadings SensorStreams::takeUntil(Time time, Time oldest) {
  SensorReadings readings;
  const auto take = [&]<typename Sample>(Stream<Sample>& stream) {
    while (stream.ordered.peek() != nullptr && stream.ordered.peek()->time <= time) {
      const Sample reading = stream.ordered.pop();
      stream.span.add(reading.time);
      if (reading.time >= oldest) readings.of<Sample>().push_back(reading);
    }
  };
  std::apply([&](auto&... streams) { (take(streams), ...); }, streams_);
  return readings;
}

void SensorStreams::shiftFrom(Time from, Duration by) {
  std::apply([&](auto&... streams) { (streams.ordered.shiftFrom(from, by), ...); }, streams_);
}

void SensorStreams::reportSpans(bool reads_on, const SpanReport& report) {
  const auto reportOne = [&]<typename Sample>(Stream<Sample>& stream) {
    while (reads_on && stream.ordered.peek() != nullptr) stream.span.add(stream.ordered.pop().time);
    report(std::string("the ") + SensorKind<Sample>::name, stream.span.get(),
           kHasTimeOffset<Sample> ? "time_offset_to_imu_s of its calibration" : "its clock");
  };
  std::apply([&](auto&... streams) { (reportOne(streams), ...); }, streams_);
}

}  // namespace lodeline

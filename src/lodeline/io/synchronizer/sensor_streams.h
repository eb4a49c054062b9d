#pragma once

#include <functional>
#include <optional>
#include <string>
#include <tuple>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/streams/time_span.h"
#include "lodeline/recording.h"
#include "lodeline/sensors/sensor_readings.h"

namespace lodeline {

/// The ordered readings of a source's sensors beside cameras and IMU, one stream for each kind.
class SensorStreams {
 public:
  /// Gives the expectation of a sensor from `kind`, `name` and `rate_hz` of StreamExpectation; the rate is 0
  /// without the sensor.
  using Expect = std::function<StreamExpectation(const char* kind, const char* name, double rate_hz)>;
  /// Gets `name` as in "the sonar", the span of the stream so far, and how to state the offset of its clock.
  using SpanReport =
      std::function<void(const std::string& name, const std::optional<TimeSpan>& span, const char* offset)>;

  /// `source` and `diagnostics` must outlive the streams.
  SensorStreams(MeasurementSource* source, const Expect& expect, Diagnostics* diagnostics);

  /// Removes and returns the readings up to `time`; drops those before `oldest`.
  SensorReadings takeUntil(Time time, Time oldest);
  /// Shifts all readings at or after `from`, where their clock jumped.
  void shiftFrom(Time from, Duration by);
  /// Reports the span of each stream. `reads_on`: with the readings that were not taken, which are removed.
  void reportSpans(bool reads_on, const SpanReport& report);

 private:
  template <typename Sample>
  struct Stream {
    OrderedStream<Sample> ordered;
    SpanOfStream span;
  };

  PerSensorKind<Stream> streams_;
};

}  // namespace lodeline

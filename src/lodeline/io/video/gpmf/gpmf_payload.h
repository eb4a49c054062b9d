#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline::gpmf {

/// One sensor's samples of a payload, with what the stream says of them.
struct Stream {
  double device = 0.0;      ///< DVID; the camera and its accessories have different ones
  std::string device_name;  ///< DVNM
  std::string name;         ///< STNM
  std::string key;          ///< e.g. "ACCL"
  size_t axes = 0;          ///< numbers of a sample
  size_t samples = 0;
  std::vector<double> values;  ///< sample by sample, divided by SCAL
  std::string unit;            ///< SIUN or UNIT of the first number, UTF-8; empty where neither is there
  /// TSMP: samples since the start of the recording, with those of this payload.
  std::optional<uint64_t> total_samples;
  std::optional<int64_t> stamp_us;  ///< STMP: time of the first sample on the camera's clock
  std::optional<int64_t> tick_ms;   ///< TICK: time at which the first sample was taken over; older cameras
  double delay_s = 0.0;             ///< TIMO: by which the samples are late
  std::string stored_axes;          ///< ORIN: axes in the order of the numbers, lower case for negative ones
  std::string output_axes;          ///< ORIO: axes in the order that MTRX gives
  std::optional<Mat3> matrix;       ///< MTRX: output_axes from stored_axes
};

/// All streams of one payload of the telemetry track.
struct Payload {
  std::vector<Stream> streams;
  std::vector<std::string> problems;  ///< parts that were left out, with the reason
};

/// Parses a payload: devices (DEVC) with streams (STRM). The last element of a stream is its data; the others
/// describe it. Never throws; what cannot be read is a problem, and the rest is returned.
Payload parsePayload(std::span<const uint8_t> bytes);

}  // namespace lodeline::gpmf

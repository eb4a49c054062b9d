#include <optional>
#include <span>

#include "lodeline/io/video/gpmf/gpmf_payload.h"
#include "lodeline/io/video/gpmf/sample_clock.h"
#include "lodeline/io/video/gpmf/stream_axes.h"

// Telemetry of a GoPro film: the input is one payload. Its streams are parsed, turned and numbered as if each
// were a payload of one sensor.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const gpmf::Payload payload = gpmf::parsePayload({data, size});
  std::vector<gpmf::PayloadSamples> payloads;
  for (const gpmf::Stream& stream : payload.streams) {
    gpmf::axesOf(stream);
    gpmf::PayloadSamples samples{static_cast<double>(payloads.size()), 1.0, stream.samples,
                                 stream.total_samples};
    if (stream.stamp_us) samples.stamp_s = 1e-6 * static_cast<double>(*stream.stamp_us);
    payloads.push_back(samples);
  }
  const gpmf::SampleClock clock(payloads);
  clock.time_s(0.0);
  return 0;
}

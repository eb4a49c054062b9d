#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/types.h"

namespace lodeline::gpmf {

/// A point of a line to be fitted.
struct ClockPoint {
  double x = 0.0;
  double y = 0.0;
};

/// y = at_centre + slope (x - centre).
struct ClockLine {
  double centre = 0.0;
  double at_centre = 0.0;
  double slope = 0.0;

  double at(double x) const { return at_centre + slope * (x - centre); }
};

/// Fits a line that single outliers do not move: medians of slopes and residuals, then least squares with
/// Huber's weights. Needs two points with different x; returns nothing otherwise.
std::optional<ClockLine> fitLine(const std::vector<ClockPoint>& points);

/// What the container and a payload state of one stream's samples.
struct PayloadSamples {
  double time_s = 0.0;    ///< start of the payload on the clock of the images
  double length_s = 0.0;  ///< of the payload; 0 where it is not known
  size_t samples = 0;
  std::optional<uint64_t> total_samples = {};  ///< TSMP
  std::optional<double> stamp_s = {};          ///< STMP of the first sample, camera's clock
  bool starts_file = false;                    ///< the first of a chapter, whose count may start anew
};

/// Times of a sensor's samples on the clock of the images.
///
/// A camera states the time of a payload, not of a sample, and takes samples over in bursts: their number in
/// a payload jitters. The number n of a sample since the start counts the sensor's own periods exactly. So
/// the time is a line t(n), fitted to the starts of all payloads within one minute on both sides; the rate
/// may follow the temperature over a long one. Where payloads have stamps (STMP), the line is fitted to
/// these, and a second line maps the camera's clock to that of the images.
class SampleClock {
 public:
  /// `clock_map`: seconds of the images' clock from the camera's; nothing to fit it to the payload times.
  explicit SampleClock(const std::vector<PayloadSamples>& payloads,
                       const std::optional<ClockLine>& clock_map = std::nullopt);

  /// Number n of the first sample of a payload, by the index of the payload.
  double firstSample(size_t payload) const { return first_sample_[payload]; }
  double time_s(double sample) const;
  double rate_hz() const { return rate_hz_; }
  double samples() const { return samples_; }    ///< from the first to the last, with missing ones
  size_t received() const { return received_; }  ///< samples that are in the payloads
  /// Median distance of the payloads' starts from the line, s: the jitter of their hand-over.
  double jitter_s() const { return jitter_s_; }
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  void number(const std::vector<PayloadSamples>& payloads);
  void fit(const std::vector<ClockPoint>& points);

  std::vector<double> first_sample_;
  std::vector<ClockPoint> knots_;  ///< fitted times of the payloads' starts
  double rate_hz_ = 0.0;
  double samples_ = 0.0;
  size_t received_ = 0;
  double jitter_s_ = 0.0;
  std::vector<std::string> problems_;
};

}  // namespace lodeline::gpmf

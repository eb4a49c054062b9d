#include "lodeline/api/recording_check.h"

#include <algorithm>

#include "lodeline/inspection/start_check.h"

namespace lodeline {

void checkRecording(const SourceFactory& open, const std::string& data, RunSettings* options,
                    Diagnostics* diagnostics) {
  StartCheckOptions start;
  start.begin_s = options->synchronizer.skip_s;
  if (options->synchronizer.duration_s > 0.0) {
    start.length_s = std::min(start.length_s, options->synchronizer.duration_s);
  }
  const StartCheck check = checkStart(open, data, start, diagnostics);
  options->synchronizer.image_offset_s = check.image_offset_s;
  options->synchronizer.inertial.rate_to_SI = check.rate_to_SI;
  options->shown_noise = check.noise;
}

}  // namespace lodeline

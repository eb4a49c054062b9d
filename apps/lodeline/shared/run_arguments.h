#pragma once

#include <vector>

#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/start_options.h"
#include "lodeline/pipeline/run_request.h"

namespace lodeline {

/// The command line of `lodeline run` and `lodeline refine`.
struct RunArguments {
  RunRequest request;
  RecordingPart part;
  std::vector<int> cameras;
  SiteArguments site;
  StartArguments start;
  Verbosity verbosity;
};

/// The request with all options applied. Throws UsageError.
RunRequest requestOf(const RunArguments& arguments);

}  // namespace lodeline

#include "apps/lodeline/shared/run_arguments.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <string>

namespace lodeline {

RunRequest requestOf(const RunArguments& arguments) {
  RunRequest request = arguments.request;
  request.site = arguments.site.numbers();
  request.date = arguments.site.date;
  request.map_start = arguments.start.start();
  request.quiet = arguments.verbosity.quiet;
  request.verbose = arguments.verbosity.verbose;
  // The part of the recording is two settings, which the command line sets like any other.
  const auto set = [&](const char* key, const std::string& value) {
    request.overrides.push_back(fmt::format("{}={}", key, value));
  };
  const RecordingPart& part = arguments.part;
  if (part.from_s > 0.0) set("source.skip_s", fmt::format("{}", part.from_s));
  if (part.to_s) set("source.duration_s", fmt::format("{}", *part.length_s()));
  if (!arguments.cameras.empty()) {
    set("source.cameras", fmt::format("[{}]", fmt::join(arguments.cameras, ", ")));
  }
  return request;
}

}  // namespace lodeline

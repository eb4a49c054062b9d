#include "apps/lodeline/shared/common_options.h"

#include <fmt/core.h>

#include <cstdio>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/output/survey/grid/place_text.h"
#include "lodeline/util/terminal/terminal.h"

namespace lodeline {
namespace {

terminal::Colour colourOf(Severity severity) {
  switch (severity) {
    case Severity::Serious:
      return terminal::Colour::Red;
    case Severity::Warning:
      return terminal::Colour::Yellow;
    case Severity::Notice:
      break;
  }
  return terminal::Colour::Cyan;
}

}  // namespace

void addVerbosity(Verbosity* verbosity, CLI::App* command) {
  command->add_flag("-v,--verbose", verbosity->verbose, "more figures, and the kind of each finding");
  command->add_flag("-q,--quiet", verbosity->quiet, "no progress and no summary");
}

void printFindings(const Diagnostics& diagnostics, const Verbosity& verbosity, std::FILE* stream) {
  if (verbosity.quiet) stream = stderr;
  const bool in_colour = terminal::hasColours(stream);
  for (const Finding& finding : diagnostics.ranked()) {
    if (verbosity.quiet && finding.severity != Severity::Serious) continue;
    const std::string severity =
        terminal::coloured(toString(finding.severity), colourOf(finding.severity), in_colour);
    const std::string kind = verbosity.verbose ? fmt::format(" [{}]", finding.kind) : "";
    const std::string times = finding.count > 1 ? fmt::format(" ({} times)", finding.count) : "";
    fmt::print(stream, "{}: {}{}{}\n", severity, finding.first_message, times, kind);
  }
}

std::optional<Vec3> SiteArguments::field_ENU() const {
  if (position.empty() && date.empty()) return std::nullopt;
  if (position.empty() || date.empty()) {
    throw UsageError("--site and --date belong together: the Earth's field depends on both");
  }
  return worldMagneticField(parsePlace(position, "--site").position, decimalYear(date)).field_ENU;
}

std::string SiteArguments::numbers() const {
  if (position.empty()) return {};
  const GeodeticPosition place = parsePlace(position, "--site").position;
  return fmt::format("{},{},{}", place.latitude_deg, place.longitude_deg, place.height_m);
}

void addSite(SiteArguments* site, CLI::App* command) {
  command
      ->add_option("--site", site->position,
                   "place of the recording, for true north and the Earth's field: "
                   "LATITUDE,LONGITUDE[,HEIGHT] (degrees, m), or another usual notation")
      ->type_name("PLACE");
  command->add_option("--date", site->date, "date of the recording, with --site")->type_name("YYYY-MM-DD");
}

std::optional<double> RecordingPart::length_s() const {
  if (!to_s) return std::nullopt;
  if (*to_s <= from_s)
    throw UsageError(fmt::format("--to {:g}: must be later than --from {:g}", *to_s, from_s));
  return *to_s - from_s;
}

void addRecordingPart(RecordingPart* part, CLI::App* command) {
  command->add_option("--from", part->from_s, "use the recording from this second on")
      ->type_name("SECONDS")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--to", part->to_s, "use the recording up to this second")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber);
}

void addCameras(std::vector<int>* cameras, CLI::App* command) {
  command->add_option("--cameras", *cameras, "numbers of the cameras to use, such as 0,1 (default: all)")
      ->type_name("N,N")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber);
}

void addOverwrite(bool* overwrite, CLI::App* command) {
  command->add_flag("--overwrite", *overwrite, "replace earlier results in the output");
}

}  // namespace lodeline

#include "apps/lodeline/export/export_foxglove.h"

#include <CLI/CLI.hpp>

#include "lodeline/output/foxglove/foxglove_file.h"
#include "lodeline/output/foxglove/foxglove_run.h"
#include "lodeline/util/choice.h"

namespace lodeline {

void addFoxgloveOptions(CLI::App* command, FoxgloveArguments* arguments) {
  command->get_option("--format")
      ->description(
          "survex, therion, geojson, kml, gpx, gpkg, dxf, ply, csv, tum, colmap, or mcap for Foxglove; "
          "several with commas");
  command->add_flag("--images", arguments->with_pictures,
                    "with --format mcap: add the sample images with tracks");
}

void takeFoxglove(std::vector<std::string>* formats, FoxgloveArguments* arguments) {
  const size_t taken =
      std::erase_if(*formats, [](const std::string& name) { return equalIgnoringCase(name, "mcap"); });
  if (taken > 0) arguments->is_wanted = true;
  if (arguments->with_pictures && !arguments->is_wanted)
    throw UsageError("--images belongs to --format mcap");
}

std::string foxgloveFileName(const std::string& name) { return name + ".mcap"; }

void writeFoxglove(const FoxgloveArguments& arguments, const std::filesystem::path& run_folder,
                   const std::filesystem::path& file, Diagnostics* diagnostics) {
  Diagnostics of_reading;
  const foxglove::Run run = foxglove::readRun(run_folder, arguments.with_pictures, &of_reading);
  foxglove::writeRun(run, file);
  for (const Finding& finding : of_reading.ranked()) {
    if (diagnostics->count(finding.kind) == 0)
      diagnostics->report(finding.severity, finding.kind, finding.first_message);
  }
}

}  // namespace lodeline

#include "lodeline/api/run_settings.h"

#include <fmt/core.h>

#include "lodeline/api/expert_settings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {
namespace {

void bindRecording(Settings* settings, RunSettings* options) {
  settings->bind(
      "source.cameras", &options->source.camera_indices,
      "Numbers of the cameras to use. The first one is the reference camera. `[]` uses all cameras.");
  settings->bind("source.image_step", &options->image_step,
                 "Use every Nth image of each camera, such as `2` for a film of 60 images a second.");
  settings->bind("source.skip_s", &options->synchronizer.skip_s,
                 "Time at the start of the recording that the run leaves out.");
  settings->bind("source.duration_s", &options->synchronizer.duration_s,
                 "Length of the part that the run reads. `0` reads the whole recording.");
  settings->bind("loops.enabled", &options->loops,
                 "Recognize places that were seen before, and write the map of the dive.");
  settings->bind("tags.size_m", &options->tag_size_m,
                 "Edge of the black square of the AprilTags (36h11) on the line. `0` where it is unknown.");
  settings->bind("tags.control", &options->tags_control,
                 "File of [control points](../how-to/control-points.md) with names, sizes and positions of "
                 "tags. Empty for none.");
}

void bindSensors(Settings* settings, RunSettings* options) {
  settings->bind("magnetometer.calibration", &options->magnetometer_calibration,
                 "File that `lodeline calibrate magnetometer` wrote. Empty for none.");
  settings->bind(
      "magnetometer.model", &options->odometry.estimator.magnetometer.use,
      {{"automatic", MagnetometerUse::Automatic},
       {"absolute", MagnetometerUse::Absolute},
       {"paper", MagnetometerUse::Paper},
       {"off", MagnetometerUse::Off}},
      "Use of the magnetometer. `automatic` is `absolute` with a calibrated magnetometer, else `off`.");
  settings->bind("magnetometer.map", &options->odometry.estimator.magnetometer.map,
                 "Map the field near steel on the first visit, and take heading from it on the next.");
  settings->bind("pressure.density_ratio", &options->odometry.estimator.depth.density_ratio,
                 "Density of the water over the density that the sensor assumes. It is 0.975 for a sensor "
                 "that is set to salt water, in fresh water.");
}

void bindHeading(Settings* settings, RunSettings* options) {
  settings->bind("heading.reference", &options->odometry.estimator.magnetometer.heading_reference,
                 {{"automatic", HeadingReference::Automatic},
                  {"true", HeadingReference::True},
                  {"magnetic", HeadingReference::Magnetic},
                  {"start", HeadingReference::Start}},
                 "Direction of the y axis of the world. `automatic` is true north with site and date, else "
                 "magnetic north.");
  settings->bind(
      "heading.site", &options->site,
      "Latitude (degrees), longitude (degrees) and height (m) of the recording. `[]` where unknown.");
  settings->bind("heading.date", &options->date, "Date of the recording, `YYYY-MM-DD`. Empty where unknown.");
}

}  // namespace

void bindRunSettings(Settings* settings, RunSettings* options) {
  bindRecording(settings, options);
  bindSensors(settings, options);
  bindHeading(settings, options);
  bindExpertSettings(settings, options);
}

std::optional<Vec3> siteField_W(const RunSettings& options) {
  if (options.site.empty() && options.date.empty()) return std::nullopt;
  if (options.site.empty() || options.date.empty()) {
    throw UsageError("true north takes both place and date: --site LAT,LON,HEIGHT --date YYYY-MM-DD");
  }
  if (options.site.size() != 3) {
    throw UsageError(fmt::format("a site is latitude_deg,longitude_deg,height_m; here are {} numbers",
                                 options.site.size()));
  }
  const GeodeticPosition site{options.site[0], options.site[1], options.site[2]};
  return worldMagneticField(site, decimalYear(options.date)).field_ENU;
}

}  // namespace lodeline

#include "lodeline/magnetometer/calibration/currents/calibrate_currents.h"

#include <fmt/format.h>

#include <fstream>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/calibration/rig_text.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"

namespace lodeline {
namespace {

/// Cuts the currents to the magnetometer's time, with a margin for a lag.
void cutToMagnetometer(StillTest* test) {
  const Duration margin = Duration::fromSeconds(2.0);
  const Time begin = test->magnetometer.front().time - margin, end = test->magnetometer.back().time + margin;
  std::erase_if(test->currents,
                [&](const CurrentSample& sample) { return sample.time < begin || sample.time > end; });
}

}  // namespace

StillTest readStillTest(MeasurementSource& source, const std::string& name, bool is_mounting_known,
                        const RecordOptions& options, const std::optional<MagnetometerFit>& iron,
                        Diagnostics* diagnostics) {
  StillTest test;
  Rig rig = source.rig();
  if (!rig.currents || rig.currents->channels.empty()) {
    throw InputError(name +
                     ": holds no electric currents (current0 with named channels); a still test needs them "
                     "beside the magnetometer");
  }
  test.channels = rig.currents->channels;
  MagnetometerRecord record = readMagnetometerRecord(source, name, is_mounting_known, options, diagnostics);
  if (record.is_raw) {
    throw InputError(name +
                     ": the magnetometer's readings are raw counts; fields of currents need tesla (--unit)");
  }
  while (std::optional<CurrentSample> sample = source.nextCurrents()) {
    if (sample->currents_A.size() != test.channels.size()) {
      throw InputError(fmt::format("{}: a reading of currents at {} ns has {} values for {} channels", name,
                                   sample->time.nanoseconds(), sample->currents_A.size(),
                                   test.channels.size()));
    }
    test.currents.push_back(std::move(*sample));
  }
  if (!rig.magnetometer) rig.magnetometer.emplace();
  if (iron) applyCalibration(*iron, name, &rig);
  test.calibration = *rig.magnetometer;
  test.magnetometer = std::move(record.magnetometer);
  test.imu = std::move(record.imu);
  cutToMagnetometer(&test);
  return test;
}

CurrentCalibrationResult calibrateCurrents(const StillTest& test,
                                           const std::optional<CurrentCalibration>& earlier,
                                           Diagnostics* diagnostics) {
  CurrentCalibrationResult result;
  result.fit = fitCurrents(test, diagnostics);
  CurrentCalibration& calibration = result.calibration;
  calibration.rate_hz = result.fit.rate_hz;
  for (const CurrentChannel& channel : result.fit.channels) {
    calibration.channels.push_back(channel.name);
    calibration.fields_T_per_A.push_back(channel.field_T_per_A);
    if (channel.isIdentified()) continue;
    diagnostics->report(Severity::Warning, "current_channel_unknown",
                        fmt::format("channel {}: {}", channel.name, channel.objection));
  }
  calibration.field_sigma_T_per_A = result.fit.field_sigma_T_per_A;
  // The fit relates stamps of both sensors; the magnetometer's offset relates them to the IMU.
  calibration.time_offset_to_imu_s = result.fit.lag_s + test.calibration.time_offset_to_imu_s;
  if (!earlier) return result;
  result.check = checkCurrents(result.fit, *earlier);
  if (result.check->is_moved)
    diagnostics->report(Severity::Serious, "current_compensation_wrong", result.check->verdict);
  return result;
}

void writeCurrentFile(const CurrentCalibrationResult& result, const std::filesystem::path& file) {
  RigFile rig;
  rig.rig.currents = result.calibration;
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << "# Fields of electric currents at the magnetometer, from a still test.\n# " << result.fit.verdict
         << "\n"
         << rigText(rig);
  stream.close();
  if (!stream)
    throw InputError(fmt::format("{}: cannot be written; check the folder and its rights", file.string()));
}

CurrentCalibration readCurrentFile(const std::filesystem::path& file) {
  Diagnostics unseen;
  const RigFile rig = readRigFiles({file}, &unseen);
  if (!rig.rig.currents) throw InputError(file.string() + ": has no section current0");
  return *rig.rig.currents;
}

}  // namespace lodeline

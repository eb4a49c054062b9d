#include "lodeline/inspection/other_sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lodeline/inspection/survey/camera_words.h"

namespace lodeline {
namespace {

constexpr double kSlowGapPeriods = 4.0;

/// Ranges of quantities with names, in the order in which they first have a value.
class ValueRanges {
 public:
  void add(const std::string& name, const char* unit, double value) {
    const auto known = std::find_if(values_.begin(), values_.end(),
                                    [&](const ValueRange& other) { return other.name == name; });
    if (known == values_.end()) {
      values_.push_back({name, unit, value, value});
      return;
    }
    known->least = std::min(known->least, value);
    known->greatest = std::max(known->greatest, value);
  }
  std::vector<ValueRange> take() { return std::move(values_); }

 private:
  std::vector<ValueRange> values_;
};

/// Surveys a stream; `add` adds the values of a reading.
template <typename Next, typename Add>
PlainSurvey surveyPlain(const std::string& sensor, const Next& next, const Add& add) {
  StreamSurvey stream;
  ValueRanges values;
  while (const auto reading = next()) {
    stream.add(reading->time);
    add(*reading, &values);
  }
  return {sensor, stream.summarize(kSlowGapPeriods), values.take(), std::nullopt};
}

PlainSurvey surveyDvl(MeasurementSource* source) {
  DvlLock lock;
  PlainSurvey survey = surveyPlain(
      "dvl0", [&] { return source->nextDvl(); },
      [&](const DvlSample& ping, ValueRanges* values) {
        lock.add(ping);
        constexpr const char* kAxes[] = {"v_x", "v_y", "v_z"};
        for (int axis = 0; ping.velocity_D && axis < 3; ++axis)
          values->add(kAxes[axis], "m/s", (*ping.velocity_D)[axis]);
        for (const DvlBeam& beam : ping.beams) {
          const std::string name = fmt::format("beam {}", beam.index);
          if (beam.velocity_m_per_s) values->add(name + " velocity", "m/s", *beam.velocity_m_per_s);
          if (beam.range_m) values->add(name + " range", "m", *beam.range_m);
        }
      });
  survey.lock = lock;
  return survey;
}

PlainSurvey surveyCurrents(MeasurementSource* source) {
  const std::vector<std::string> channels = source->rig().currents->channels;
  return surveyPlain(
      "current0", [&] { return source->nextCurrents(); },
      [&](const CurrentSample& sample, ValueRanges* values) {
        for (size_t i = 0; i < sample.currents_A.size(); ++i) {
          const std::string name = i < channels.size() ? channels[i] : fmt::format("channel {}", i);
          values->add(name, "A", sample.currents_A[i]);
        }
      });
}

}  // namespace

std::vector<PlainSurvey> surveyOtherSensors(MeasurementSource* source) {
  std::vector<PlainSurvey> surveys;
  const Rig& rig = source->rig();
  if (rig.pressure) {
    surveys.push_back(surveyPlain(
        "pressure0", [&] { return source->nextDepth(); },
        [](const DepthSample& sample, ValueRanges* values) { values->add("depth", "m", sample.depth_m); }));
  }
  if (rig.sonar) {
    surveys.push_back(surveyPlain(
        "sonar0", [&] { return source->nextSonar(); },
        [](const SonarSample& sample, ValueRanges* values) { values->add("range", "m", sample.range_m); }));
  }
  if (rig.altimeter) {
    surveys.push_back(surveyPlain(
        "altimeter0", [&] { return source->nextAltimeter(); },
        [](const AltimeterSample& sample, ValueRanges* values) {
          values->add("range", "m", sample.range_m);
        }));
  }
  if (rig.dvl) surveys.push_back(surveyDvl(source));
  if (rig.currents) surveys.push_back(surveyCurrents(source));
  return surveys;
}

void compareRobotSensors(const SourceFactory& open, Inspection* inspection) {
  const Rig& rig = inspection->rig;
  const bool has_currents =
      rig.currents && inspection->magnetometer && inspection->magnetometer->field_T > 0.0;
  if (!rig.dvl && !has_currents) return;
  std::vector<ImuSample> imu = inspection->imu.samples;
  for (ImuSample& sample : imu) sample.angular_velocity_B *= inspection->rate_to_SI;
  const InertialPath path(imu, medianRate_B(imu));
  Diagnostics reported_before;
  const std::unique_ptr<MeasurementSource> source = open(&reported_before);
  if (rig.dvl) {
    std::vector<DvlSample> pings;
    while (std::optional<DvlSample> ping = source->nextDvl()) pings.push_back(std::move(*ping));
    inspection->dvl = compareDvl(pings, *rig.dvl, path);
    if (!inspection->cameras.empty() && isCalibrated(rig.cameras.front())) {
      inspection->dvl_images =
          compareDvlWithImages(inspection->cameras.front().survey.pairs, rig.cameras.front().body_from_camera,
                               pings, *rig.dvl, path);
    }
  }
  if (!has_currents) return;
  std::vector<MagnetometerSample> field;
  while (const std::optional<MagnetometerSample> sample = source->nextMagnetometer())
    field.push_back(*sample);
  std::stable_sort(field.begin(), field.end(),
                   [](const MagnetometerSample& a, const MagnetometerSample& b) { return a.time < b.time; });
  std::vector<CurrentSample> currents;
  while (std::optional<CurrentSample> sample = source->nextCurrents()) currents.push_back(std::move(*sample));
  inspection->currents =
      compareCurrents(field, currents, rig, teslaPer(inspection->magnetometer->unit), path);
}

}  // namespace lodeline

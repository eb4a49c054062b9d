#include "lodeline/io/rosbag/robots/dvl_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodeline::messages {
namespace {

constexpr double kNotKnown = std::numeric_limits<double>::quiet_NaN();
constexpr uint8_t kBottomMode = 1, kWaterMode = 2;  // velocity_mode of marine_acoustic_msgs

/// Root of the mean variance of the three axes at the given places; NaN where the message does not state it.
double sigmaOf(std::span<const double> covariance, std::array<size_t, 3> diagonal) {
  double sum = 0.0;
  for (const size_t place : diagonal) {
    if (!(covariance[place] > 0.0) || !std::isfinite(covariance[place])) return kNotKnown;
    sum += covariance[place];
  }
  return std::sqrt(sum / 3.0);
}

template <size_t kCount>
std::array<double, kCount> takeDoubles(wire::Reader* reader) {
  std::array<double, kCount> numbers;
  for (double& number : numbers) number = reader->take<double>();
  return numbers;
}

DvlReading parseMarine(wire::Reader* reader) {
  DvlReading reading;
  StatedDvlPing& ping = reading.ping;
  ping.time = takeHeader(reader);
  ping.track = reader->take<uint8_t>() == kWaterMode ? DvlTrack::Water : DvlTrack::Bottom;
  reader->take<uint8_t>();  // kind of array
  ping.velocity_D = takeVector(reader);
  ping.velocity_sigma_m_per_s = sigmaOf(takeDoubles<9>(reader), {0, 4, 8});
  takeDoubles<3>(reader);  // altitude, course, speed
  const auto good_beams = reader->take<uint8_t>();
  reader->take<float>();  // speed of sound
  const bool has_ranges = reader->take<uint8_t>() != 0, has_velocities = reader->take<uint8_t>() != 0;
  // Some drivers leave the number of good beams at 0; a velocity of exactly 0 then is none.
  constexpr int kFewest = 3;
  if (good_beams > 0) ping.is_velocity_valid = good_beams >= kFewest;
  for (size_t i = 0; i < kMarineBeams; ++i) reading.beams_D.push_back(takeVector(reader));
  std::array<StatedDvlBeam, kMarineBeams> beams;
  for (size_t i = 0; i < kMarineBeams; ++i) {
    beams[i].index = static_cast<int>(i);
    const auto range = reader->take<double>();
    if (has_ranges) beams[i].range_m = range;
  }
  reader->takeBytes(2 * kMarineBeams * sizeof(float));  // variance of the ranges, quality
  for (StatedDvlBeam& beam : beams) {
    const auto velocity = decimal(reader->take<float>());
    if (has_velocities) beam.velocity_m_per_s = velocity;
  }
  reader->takeBytes(kMarineBeams * sizeof(float));  // variance of the velocities
  if (has_ranges || has_velocities) ping.beams.assign(beams.begin(), beams.end());
  const bool has_vectors =
      std::all_of(reading.beams_D.begin(), reading.beams_D.end(), [](const Vec3& beam_D) {
        constexpr double kTolerance = 0.02;
        return std::abs(beam_D.norm() - 1.0) < kTolerance;
      });
  if (!has_vectors) reading.beams_D.clear();
  return reading;
}

/// Parses Water Linked's message. `is_second`: that of ROS 2, with a covariance.
DvlReading parseA50(bool is_second, wire::Reader* reader) {
  DvlReading reading;
  StatedDvlPing& ping = reading.ping;
  ping.time = takeHeader(reader);
  reader->take<double>();  // time since the last message, ms
  ping.velocity_D = takeVector(reader);
  ping.velocity_sigma_m_per_s = reader->take<double>();  // figure of merit
  if (is_second) reader->takeBytes(reader->take<uint32_t>() * sizeof(double));
  reader->take<double>();  // altitude
  const auto count = reader->take<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    StatedDvlBeam beam;
    const auto number = reader->take<int64_t>();
    beam.index = number >= 0 && number < std::numeric_limits<int>::max() ? static_cast<int>(number) : -1;
    beam.velocity_m_per_s = reader->take<double>();
    beam.range_m = reader->take<double>();
    reader->takeBytes(2 * sizeof(double));  // strength of signal and noise
    beam.is_valid = reader->take<uint8_t>() != 0;
    ping.beams.push_back(beam);
  }
  ping.is_velocity_valid = reader->take<uint8_t>() != 0;
  countBeamsFromZero(&ping);
  return reading;
}

/// Parses the message of the UUV simulator. A variance below 0 says that the reading is not valid.
DvlReading parseSimulated(wire::Reader* reader) {
  DvlReading reading;
  StatedDvlPing& ping = reading.ping;
  ping.time = takeHeader(reader);
  ping.velocity_D = takeVector(reader);
  const std::array<double, 9> covariance = takeDoubles<9>(reader);
  if (covariance[0] < 0.0) ping.is_velocity_valid = false;
  ping.velocity_sigma_m_per_s = sigmaOf(covariance, {0, 4, 8});
  reader->take<double>();  // altitude
  const auto count = reader->take<uint32_t>();
  for (uint32_t i = 0; i < count; ++i) {
    StatedDvlBeam beam;
    beam.index = static_cast<int>(i);
    beam.range_m = reader->take<double>();
    const bool has_range = reader->take<double>() >= 0.0;
    beam.velocity_m_per_s = reader->take<double>();
    if (!(reader->take<double>() >= 0.0)) beam.is_valid = false;
    if (!has_range) beam.range_m = kNotKnown;
    takeHeader(reader);
    takePose(reader);
    ping.beams.push_back(beam);
  }
  return reading;
}

DvlReading parseTwist(bool has_covariance, wire::Reader* reader) {
  DvlReading reading;
  reading.ping.time = takeHeader(reader);
  reading.ping.velocity_D = takeVector(reader);
  takeVector(reader);  // angular velocity
  if (has_covariance) reading.ping.velocity_sigma_m_per_s = sigmaOf(takeDoubles<36>(reader), {0, 7, 14});
  return reading;
}

}  // namespace

DvlReading parseDvl(const std::string& type, std::span<const uint8_t> message) {
  wire::Reader reader(message);
  if (type == kMarineDvl.name) return parseMarine(&reader);
  if (type == kA50Dvl.name || type == kA50Dvl2.name) return parseA50(type == kA50Dvl2.name, &reader);
  if (type == kSimulatedDvl.name || type == kColaDvl.name) return parseSimulated(&reader);
  return parseTwist(type == kTwistWithCovariance.name, &reader);
}

wire::Bytes marineDvl(const DvlSample& sample, const std::vector<Vec3>& beams_D, uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "dvl0", &writer);
  writer.put(sample.track == DvlTrack::Water ? kWaterMode : kBottomMode);
  writer.put(uint8_t{0});  // single transducers
  putVector(sample.velocity_D.value_or(Vec3::Constant(kNotKnown)), &writer);
  const double sigma = sample.velocity_sigma_m_per_s.value_or(0.0);
  for (int i = 0; i < 9; ++i) {
    const double variance = sample.velocity_sigma_m_per_s ? sigma * sigma : -1.0;
    writer.put(i % 4 == 0 || variance < 0.0 ? variance : 0.0);
  }
  for (int i = 0; i < 3; ++i) writer.put(kNotKnown);  // altitude, course, speed
  writer.put(static_cast<uint8_t>(sample.velocity_D ? kMarineBeams : 0));
  writer.put(0.0F);  // speed of sound not known
  std::array<DvlBeam, kMarineBeams> beams;
  for (const DvlBeam& beam : sample.beams) {
    if (beam.index >= 0 && static_cast<size_t>(beam.index) < kMarineBeams)
      beams[static_cast<size_t>(beam.index)] = beam;
  }
  for (int i = 0; i < 2; ++i) writer.put(static_cast<uint8_t>(!sample.beams.empty()));
  for (size_t i = 0; i < kMarineBeams; ++i)
    putVector(i < beams_D.size() ? beams_D[i] : Vec3(Vec3::Zero()), &writer);
  for (const DvlBeam& beam : beams) writer.put(beam.range_m.value_or(kNotKnown));
  for (size_t i = 0; i < kMarineBeams; ++i) writer.put(-1.0F);
  for (size_t i = 0; i < kMarineBeams; ++i) writer.put(0.0F);
  for (const DvlBeam& beam : beams) writer.put(static_cast<float>(beam.velocity_m_per_s.value_or(kNotKnown)));
  for (size_t i = 0; i < kMarineBeams; ++i) writer.put(-1.0F);
  return writer.take();
}

std::optional<double> beamDifference_rad(const std::vector<Vec3>& stated_D,
                                         const std::vector<Vec3>& beams_D) {
  if (stated_D.empty()) return std::nullopt;
  double greatest = 0.0;
  for (size_t i = 0; i < std::min(stated_D.size(), beams_D.size()); ++i) {
    const double sine = stated_D[i].cross(beams_D[i]).norm();
    greatest = std::max(greatest, std::atan2(sine, stated_D[i].dot(beams_D[i])));
  }
  return greatest;
}

}  // namespace lodeline::messages

#include "lodeline/io/rosbag/messages.h"

#include <cmath>
#include <limits>

#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

namespace lodeline::messages {
namespace {

constexpr size_t kCovarianceBytes = 9 * sizeof(double);

/// Writes an all-zero covariance, which means unknown; `first` -1 means that the quantity is missing.
void putCovariance(double first, wire::Writer* writer) {
  writer->put(first);
  for (int i = 1; i < 9; ++i) writer->put(0.0);
}

bool isWithin(float range, float least, float greatest) {
  return std::isfinite(range) && range >= least && range <= greatest;
}

}  // namespace

std::vector<Type> typesOf(const std::string& sensor) {
  if (sensor == "imu0") return {messages::kImu};
  if (sensor == "mag0") return {messages::kMagneticField};
  if (sensor == "pressure0") return {messages::kFluidPressure};
  if (sensor == "sonar0") return {messages::kLaserScan, messages::kRange};
  if (sensor == "altimeter0") return {messages::kRange};
  if (sensor == "dvl0") return {kMarineDvl, kA50Dvl, kA50Dvl2, kSimulatedDvl, kColaDvl};
  if (sensor == "current0") return {kBatteryState};
  return {messages::kImage, messages::kCompressedImage, messages::kCompressedVideo};
}

std::vector<Type> namedTypesOf(const std::string& sensor) {
  std::vector<Type> types = typesOf(sensor);
  if (sensor == "mag0") types.push_back(kVector3Stamped);
  if (sensor == "pressure0") types.push_back(kOdometry);
  if (sensor == "dvl0") types.insert(types.end(), {kTwist, kTwistWithCovariance});
  if (sensor == "current0") types.push_back(kJointState);
  return types;
}

Time stampOf(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  return takeHeader(&reader);
}

ImuSample parseImu(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  ImuSample sample;
  sample.time = takeHeader(&reader);
  reader.takeBytes(4 * sizeof(double) + kCovarianceBytes);  // orientation
  sample.angular_velocity_B = takeVector(&reader);
  reader.takeBytes(kCovarianceBytes);
  sample.specific_force_B = takeVector(&reader);
  return sample;
}

MagnetometerSample parseMagneticField(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  return {time, takeVector(&reader)};
}

DepthSample parseFluidPressure(std::span<const uint8_t> message, const WaterColumn& water) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  return {time, water.depth_m(reader.take<double>())};
}

DepthSample parseOdometryDepth(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  reader.takeText();  // frame of the body
  return {time, -takeVector(&reader).z()};
}

std::vector<SonarSample> parseRange(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  reader.take<uint8_t>();  // kind of radiation
  reader.take<float>();    // width of the beam
  const auto least = reader.take<float>();
  const auto greatest = reader.take<float>();
  const auto range = reader.take<float>();
  if (!isWithin(range, least, greatest)) return {};
  return {{time, decimal(range), 0.0}};
}

std::vector<AltimeterSample> parseAltimeter(std::span<const uint8_t> message) {
  std::vector<AltimeterSample> echoes;
  for (const SonarSample& echo : parseRange(message)) {
    if (echo.range_m > 0.0) echoes.push_back({echo.time, echo.range_m});
  }
  return echoes;
}

std::vector<SonarSample> parseLaserScan(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  const auto first_angle = reader.take<float>();
  reader.take<float>();  // last angle
  const auto angle_step = reader.take<float>();
  const auto time_step_s = reader.take<float>();
  reader.take<float>();  // time of a scan
  const auto least = reader.take<float>();
  const auto greatest = reader.take<float>();
  const auto count = reader.take<uint32_t>();
  std::vector<SonarSample> echoes;
  for (uint32_t i = 0; i < count; ++i) {
    const auto range = reader.take<float>();
    if (!isWithin(range, least, greatest)) continue;
    echoes.push_back({time + Duration::fromSeconds(i * static_cast<double>(time_step_s)), decimal(range),
                      decimal(first_angle) + i * decimal(angle_step)});
  }
  return echoes;
}

StampedPosition parsePoseStamped(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  return {time, takePose(&reader)};
}

StampedPosition parseOdometryPose(std::span<const uint8_t> message) {
  wire::Reader reader(message);
  const Time time = takeHeader(&reader);
  reader.takeText();  // frame of the body
  return {time, takePose(&reader)};
}

wire::Bytes imu(const ImuSample& sample, uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "imu0", &writer);
  putVector(Vec3::Zero(), &writer);
  writer.put(1.0);
  putCovariance(-1.0, &writer);
  putVector(sample.angular_velocity_B, &writer);
  putCovariance(0.0, &writer);
  putVector(sample.specific_force_B, &writer);
  putCovariance(0.0, &writer);
  return writer.take();
}

wire::Bytes magneticField(const MagnetometerSample& sample, uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "mag0", &writer);
  putVector(sample.field_M, &writer);
  putCovariance(0.0, &writer);
  return writer.take();
}

wire::Bytes fluidPressure(const DepthSample& sample, const WaterColumn& water, uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "pressure0", &writer);
  writer.put(water.pressure_Pa(sample.depth_m));
  writer.put(0.0);  // variance not known
  return writer.take();
}

wire::Bytes laserScan(const SonarSample& sample, uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "sonar0", &writer);
  const auto angle = static_cast<float>(sample.angle_rad);
  for (const float value : {angle, angle, 0.0F, 0.0F, 0.0F, 0.0F, std::numeric_limits<float>::max()}) {
    writer.put(value);
  }
  writer.put(uint32_t{1});
  writer.put(static_cast<float>(sample.range_m));
  writer.put(uint32_t{0});  // no intensities
  return writer.take();
}

wire::Bytes altimeterRange(const AltimeterSample& sample, uint32_t sequence) {
  constexpr uint8_t kUltrasound = 0;
  wire::Writer writer;
  putHeader(sample.time, sequence, "altimeter0", &writer);
  writer.put(kUltrasound);
  for (const float value :
       {0.0F, 0.0F, std::numeric_limits<float>::max(), static_cast<float>(sample.range_m)}) {
    writer.put(value);
  }
  return writer.take();
}

wire::Bytes poseStamped(const StampedPosition& pose, uint32_t sequence) {
  wire::Writer writer;
  putHeader(pose.time, sequence, "world", &writer);
  putVector(pose.world_from_body.translation, &writer);
  const Quat& q = pose.world_from_body.rotation;
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) writer.put(value);
  return writer.take();
}

}  // namespace lodeline::messages

#include "lodeline/io/rosbag/messages.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "lodeline/io/rosbag/message_fields.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"
#include "lodeline/io/rosbag/robots/robot_messages.h"

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

Time takeHeader(wire::Reader* reader) {
  reader->take<uint32_t>();  // sequence number
  const Time stamp = reader->takeTime();
  reader->takeText();  // frame
  return stamp;
}

void putHeader(Time stamp, uint32_t sequence, std::string_view frame, wire::Writer* writer) {
  writer->put(sequence);
  writer->putTime(stamp);
  writer->putText(frame);
}

Vec3 takeVector(wire::Reader* reader) {
  const double x = reader->take<double>();
  const double y = reader->take<double>();
  return {x, y, reader->take<double>()};
}

Rigid3 takePose(wire::Reader* reader) {
  const Vec3 translation = takeVector(reader);
  const Vec3 imaginary = takeVector(reader);
  return {Quat(reader->take<double>(), imaginary.x(), imaginary.y(), imaginary.z()), translation};
}

void putVector(const Vec3& vector, wire::Writer* writer) {
  for (const double value : {vector.x(), vector.y(), vector.z()}) writer->put(value);
}

double decimal(float value) {
  if (!std::isfinite(value)) return value;
  const std::string text = fmt::format("{}", value);
  double number = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

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

wire::Bytes poseStamped(const StampedPosition& pose, uint32_t sequence) {
  wire::Writer writer;
  putHeader(pose.time, sequence, "world", &writer);
  putVector(pose.world_from_body.translation, &writer);
  const Quat& q = pose.world_from_body.rotation;
  for (const double value : {q.x(), q.y(), q.z(), q.w()}) writer.put(value);
  return writer.take();
}

}  // namespace lodeline::messages

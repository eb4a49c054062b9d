#include "lodeline/io/rosbag/definitions/message_fields.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace lodeline::messages {

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

}  // namespace lodeline::messages

#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>

#include <cstring>

#include "lodeline/io/rosbag/chunks/wire.h"

namespace lodeline {

/// A message of any type as the bytes that a bag would store, so that the same functions decode live topics
/// and bags.
struct RawMessage {
  wire::Bytes bytes;
};

}  // namespace lodeline

namespace ros::message_traits {

template <>
struct IsMessage<lodeline::RawMessage> : TrueType {};

template <>
struct MD5Sum<lodeline::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const lodeline::RawMessage&) { return value(); }
};

template <>
struct DataType<lodeline::RawMessage> {
  static const char* value() { return "*"; }
  static const char* value(const lodeline::RawMessage&) { return value(); }
};

template <>
struct Definition<lodeline::RawMessage> {
  static const char* value() { return ""; }
  static const char* value(const lodeline::RawMessage&) { return value(); }
};

}  // namespace ros::message_traits

namespace ros::serialization {

template <>
struct Serializer<lodeline::RawMessage> {
  template <typename Stream>
  static void read(Stream& stream, lodeline::RawMessage& message) {
    const uint32_t size = stream.getLength();
    message.bytes.resize(size);
    if (size > 0) std::memcpy(message.bytes.data(), stream.advance(size), size);
  }
  template <typename Stream>
  static void write(Stream& stream, const lodeline::RawMessage& message) {
    const auto size = static_cast<uint32_t>(message.bytes.size());
    if (size > 0) std::memcpy(stream.advance(size), message.bytes.data(), size);
  }
  static uint32_t serializedLength(const lodeline::RawMessage& message) {
    return static_cast<uint32_t>(message.bytes.size());
  }
};

}  // namespace ros::serialization

#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>

#include "lodeline/geometry/so3.h"
#include "lodeline/io/rosbag/definitions/field_writer.h"
#include "lodeline/types.h"

namespace lodeline {

/// Writes the fields of a message one after the other, in ROS 1's serialization or in the CDR of ROS 2.
class MessageWriter {
 public:
  using Serialization = definitions::Serialization;

  explicit MessageWriter(Serialization serialization, size_t size_hint = 0)
      : is_ros1_(serialization == Serialization::Ros1), writer_(serialization, size_hint) {}

  template <typename Number>
  void put(Number number) {
    const auto raw = std::bit_cast<std::array<uint8_t, sizeof(Number)>>(number);
    writer_.numbers(raw, sizeof(Number), false);
  }
  void put(const Vec3& vector) {
    for (const double value : vector) put(value);
  }
  void put(const Quat& any_sign) {
    for (const double value : so3::canonical(any_sign).coeffs()) put(value);  // x, y, z, w
  }
  void put(const Rigid3& pose) {
    put(pose.translation);
    put(pose.rotation);
  }
  /// 36 numbers, row by row.
  void put(const Eigen::Matrix<double, 6, 6>& covariance) {
    for (const auto& row : covariance.rowwise()) {
      for (const double value : row) put(value);
    }
  }

  void text(std::string_view text) { writer_.text(text); }
  /// Number of elements of a list, which follow.
  void count(size_t elements) { writer_.count(static_cast<uint32_t>(elements)); }
  /// A list of bytes.
  void bytes(std::span<const uint8_t> bytes) {
    count(bytes.size());
    writer_.numbers(bytes, 1, false);
  }

  /// A std_msgs/Header. Throws std::runtime_error for times that a message cannot hold: before 1970, or after
  /// 2106 in ROS 1 and 2038 in ROS 2.
  void header(Time time, std::string_view frame) {
    const int64_t seconds = time.nanoseconds() / kSecond;
    if (time.nanoseconds() < 0 || seconds > (is_ros1_ ? int64_t{UINT32_MAX} : int64_t{INT32_MAX})) {
      throw std::runtime_error("a time that a header of ROS cannot hold");
    }
    if (is_ros1_) put(uint32_t{0});  // sequence number, which publishers set
    put(static_cast<uint32_t>(seconds));
    put(static_cast<uint32_t>(time.nanoseconds() % kSecond));
    text(frame);
  }

  wire::Bytes take() { return writer_.take(); }

 private:
  static constexpr int64_t kSecond = 1'000'000'000;

  bool is_ros1_;
  definitions::FieldWriter writer_;
};

}  // namespace lodeline

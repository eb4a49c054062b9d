#pragma once

#include <cmath>
#include <compare>
#include <cstdint>

namespace lodeline {

/// A span of time with nanosecond resolution.
class Duration {
 public:
  constexpr Duration() = default;
  static constexpr Duration fromNanoseconds(int64_t ns) { return Duration(ns); }
  static Duration fromSeconds(double seconds) { return Duration(std::llround(seconds * 1e9)); }

  constexpr int64_t nanoseconds() const { return ns_; }
  constexpr double seconds() const { return static_cast<double>(ns_) * 1e-9; }

  constexpr auto operator<=>(const Duration&) const = default;
  constexpr Duration operator-() const { return Duration(-ns_); }
  constexpr Duration operator+(Duration other) const { return Duration(ns_ + other.ns_); }
  constexpr Duration operator-(Duration other) const { return Duration(ns_ - other.ns_); }

 private:
  explicit constexpr Duration(int64_t ns) : ns_(ns) {}
  int64_t ns_ = 0;
};

/// A point in time on the recording's clock: integer nanoseconds since the epoch of that clock. A double
/// would lose microseconds at current Unix times, so all interfaces use the integer.
class Time {
 public:
  constexpr Time() = default;
  static constexpr Time fromNanoseconds(int64_t ns) { return Time(ns); }
  static Time fromSeconds(double seconds) { return Time(std::llround(seconds * 1e9)); }

  constexpr int64_t nanoseconds() const { return ns_; }
  constexpr double seconds() const { return static_cast<double>(ns_) * 1e-9; }

  constexpr auto operator<=>(const Time&) const = default;
  constexpr Duration operator-(Time other) const { return Duration::fromNanoseconds(ns_ - other.ns_); }
  constexpr Time operator+(Duration d) const { return Time(ns_ + d.nanoseconds()); }
  constexpr Time operator-(Duration d) const { return Time(ns_ - d.nanoseconds()); }

 private:
  explicit constexpr Time(int64_t ns) : ns_(ns) {}
  int64_t ns_ = 0;
};

}  // namespace lodeline

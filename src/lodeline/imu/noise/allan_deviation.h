#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Allan variance of three axes at one averaging time.
struct AllanPoint {
  int64_t factor = 0;  ///< averaging time in readings
  int64_t stride = 0;  ///< number of readings between the starts of successive differences
  int64_t terms = 0;   ///< number of differences averaged
  double tau_s = 0.0;
  Vec3 variance = Vec3::Zero();  ///< unit of the reading, squared

  Vec3 deviation() const { return variance.cwiseSqrt(); }
};

struct AllanCurve {
  double interval_s = 0.0;
  double duration_s = 0.0;  ///< of all readings, without the breaks
  std::vector<AllanPoint> points;
};

/// Overlapping Allan variance (IEEE 952-1997, annex C; Riley, NIST SP 1065, 2008, section 5.2.4) of evenly
/// spaced readings with axes x, y, z. It is computed in one pass, with memory that grows with the logarithm
/// of the record's length.
///
/// The variance at averaging time tau is the mean square of the second difference x(t+2 tau) - 2 x(t+tau) +
/// x(t) of the integrated readings, divided by 2 tau^2. The integral is stored at full rate for tau up to 28
/// readings. For each higher octave it is decimated by another factor of two. Differences then start every
/// tau/28 to tau/16 instead of at every reading. This loses almost no information, because neighbouring
/// differences are nearly equal.
class AllanAccumulator {
 public:
  void add(const Vec3& reading);

  /// Marks a break after the last reading: no difference spans it.
  void breakOff();

  int64_t count() const { return count_; }

  /// Allan variance at four averaging times per octave, up to half of the longest unbroken stretch.
  AllanCurve curve(double interval_s) const;

 private:
  static constexpr int kFirstFactor = 16;  ///< smallest of the higher octaves, in decimated readings
  static constexpr int kHistory = 64;      ///< power of two, at least 2 * 28 + 1

  struct Sum {
    int factor = 0;
    int64_t terms = 0;
    Eigen::Array3d squares = Eigen::Array3d::Zero();
  };
  /// The integral at every 2^level-th reading.
  struct Level {
    std::array<Eigen::Array3d, kHistory> integral;
    int64_t count = 0;  ///< number of values since the last break
    std::vector<Sum> sums;
  };

  static Level makeLevel(bool is_first);
  static void add(const Eigen::Array3d& integral, Level* level);

  std::vector<Level> levels_;
  Eigen::Array3d origin_ = Eigen::Array3d::Zero();    ///< subtracted for numerical precision
  Eigen::Array3d integral_ = Eigen::Array3d::Zero();  ///< of reading - origin, times the interval
  int64_t since_break_ = 0;
  int64_t count_ = 0;
};

}  // namespace lodeline

#include "lodeline/evaluation/errors/orientation_order.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

constexpr std::size_t kMostPairs = 300;
constexpr std::size_t kFewestPairs = 10;
constexpr double kDoubtful = 10.0 * M_PI / 180.0;  ///< rms (rad) from which other orders are tried
constexpr double kFarBetter = 0.2;                 ///< of that rms
constexpr double kSameRms = 1e-3;                  ///< rad; of two orders with equal rms the first counts

using Rotations = std::vector<Mat3>;

struct Reading {
  const char* what;
  Quat (*read)(const Quat&);
};

/// The intended quaternion if the file was read in another order.
constexpr std::array<Reading, 5> kReadings = {{
    {"w first", [](const Quat& q) { return Quat(q.x(), q.y(), q.z(), q.w()); }},
    {"w last", [](const Quat& q) { return Quat(q.z(), q.w(), q.x(), q.y()); }},
    {"inverse", [](const Quat& q) { return q.conjugate(); }},
    {"w first and inverse", [](const Quat& q) { return Quat(q.x(), q.y(), q.z(), q.w()).conjugate(); }},
    {"w last and inverse", [](const Quat& q) { return Quat(q.z(), q.w(), q.x(), q.y()).conjugate(); }},
}};

Mat3 nearestRotation(const Mat3& matrix) {
  const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0) signs.z() = -1.0;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

/// Rms angle (rad) between a_i and W b_i B for the best constant B, and the given W or the best, by
/// alternation.
double disagreement(const Rotations& a, const Rotations& b, const std::optional<Mat3>& known_world) {
  Mat3 world = known_world.value_or(Mat3::Identity()), body = Mat3::Identity();
  for (int iteration = 0; iteration < (known_world ? 1 : 15); ++iteration) {
    Mat3 sum = Mat3::Zero();
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * (b[i] * body).transpose();
    if (!known_world) world = nearestRotation(sum);
    sum.setZero();
    for (std::size_t i = 0; i < a.size(); ++i) sum += (world * b[i]).transpose() * a[i];
    body = nearestRotation(sum);
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double angle = Eigen::AngleAxisd(a[i].transpose() * world * b[i] * body).angle();
    squares += angle * angle;
  }
  return std::sqrt(squares / static_cast<double>(a.size()));
}

template <typename Read>
Rotations rotationsOf(const std::vector<Rigid3>& poses, Read read) {
  Rotations rotations;
  const std::size_t step = 1 + poses.size() / kMostPairs;
  for (std::size_t i = 0; i < poses.size(); i += step) {
    rotations.push_back(read(poses[i].rotation).normalized().toRotationMatrix());
  }
  return rotations;
}

/// The error in the order; empty where there is none, or where no other order fits.
std::string findingOf(const PosePairs& pairs, const std::optional<Mat3>& estimate_from_reference) {
  const auto asRead = [](const Quat& q) { return q; };
  const Rotations estimate = rotationsOf(pairs.estimate, asRead);
  const Rotations reference = rotationsOf(pairs.reference, asRead);
  const double as_read = disagreement(estimate, reference, estimate_from_reference);
  if (as_read < kDoubtful) return {};
  double best = kFarBetter * as_read;
  std::string finding;
  const auto consider = [&](double rms, const char* which, const Reading& reading) {
    if (rms > best - kSameRms) return;
    best = rms;
    finding = fmt::format(
        "the orientations disagree by {:.1f} deg rms; with the quaternions of the {} read as {} by {:.2f} "
        "deg: "
        "check the order of the columns of both files and --format",
        as_read * 180.0 / M_PI, which, reading.what, rms * 180.0 / M_PI);
  };
  // Between equal frames, correcting either file gives the same agreement: the estimate is tried first.
  for (const Reading& reading : kReadings) {
    const Rotations other = rotationsOf(pairs.estimate, reading.read);
    consider(disagreement(other, reference, estimate_from_reference), "estimate", reading);
  }
  for (const Reading& reading : kReadings) {
    const Rotations other = rotationsOf(pairs.reference, reading.read);
    consider(disagreement(estimate, other, estimate_from_reference), "reference", reading);
  }
  return finding;
}

}  // namespace

void checkOrientationOrder(const PosePairs& pairs, Diagnostics& diagnostics) {
  if (pairs.size() < kFewestPairs) return;
  // Rotations about one axis and their inverses differ by constant rotations only: the positions must
  // determine the world.
  const Alignment by_positions = align(AlignmentType::SE3, pairs);
  std::string finding;
  if (!by_positions.rotation_from_orientations) {
    const Quat& reference_from_estimate = by_positions.reference_from_estimate.rotation;
    finding = findingOf(pairs, Mat3(reference_from_estimate.conjugate().toRotationMatrix()));
  }
  if (finding.empty()) finding = findingOf(pairs, std::nullopt);
  if (!finding.empty()) diagnostics.report(Severity::Warning, "quaternion_order", finding);
}

}  // namespace lodeline

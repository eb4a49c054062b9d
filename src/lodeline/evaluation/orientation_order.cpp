#include "lodeline/evaluation/orientation_order.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <array>
#include <cmath>

namespace lodeline {
namespace {

constexpr std::size_t kMostPairs = 300;
constexpr std::size_t kFewestPairs = 10;
constexpr double kDoubtful = 10.0 * M_PI / 180.0;  ///< rms (rad) from which on another order is tried
constexpr double kFarBetter = 0.2;                 ///< of that rms

using Rotations = std::vector<Mat3>;

struct Reading {
  const char* what;
  Quat (*read)(const Quat&);
};

/// The quaternion that the file means where it was read in another order.
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

/// Rms angle (rad) between a_i and W b_i B for the best constant rotations W and B, found in turns.
double disagreement(const Rotations& a, const Rotations& b) {
  Mat3 world = Mat3::Identity(), body = Mat3::Identity();
  for (int iteration = 0; iteration < 15; ++iteration) {
    Mat3 sum = Mat3::Zero();
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * (b[i] * body).transpose();
    world = nearestRotation(sum);
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

}  // namespace

void checkOrientationOrder(const PosePairs& pairs, Diagnostics& diagnostics) {
  if (pairs.size() < kFewestPairs) return;
  const auto asRead = [](const Quat& q) { return q; };
  const Rotations estimate = rotationsOf(pairs.estimate, asRead);
  const Rotations reference = rotationsOf(pairs.reference, asRead);
  const double as_read = disagreement(estimate, reference);
  if (as_read < kDoubtful) return;
  double best = kFarBetter * as_read;
  std::string finding;
  for (const Reading& reading : kReadings) {
    const auto consider = [&](double rms, const char* which) {
      if (rms >= best) return;
      best = rms;
      finding = fmt::format(
          "the orientations disagree by {:.1f} deg rms; with the quaternions of the {} read as {} by "
          "{:.2f} deg: check the order of its columns and --format",
          as_read * 180.0 / M_PI, which, reading.what, rms * 180.0 / M_PI);
    };
    consider(disagreement(rotationsOf(pairs.estimate, reading.read), reference), "estimate");
    consider(disagreement(estimate, rotationsOf(pairs.reference, reading.read)), "reference");
  }
  if (!finding.empty()) diagnostics.report(Severity::Warning, "quaternion_order", finding);
}

}  // namespace lodeline

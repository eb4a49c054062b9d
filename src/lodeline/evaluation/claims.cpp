#include "lodeline/evaluation/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

// By the beginnings of their names, which the units follow.
constexpr std::array<const char*, 13> kColumns = {
    "p_x",       "p_y",       "p_z",       "q_w",           "q_x",           "q_y",          "q_z",
    "sigma_p_x", "sigma_p_y", "sigma_p_z", "sigma_theta_x", "sigma_theta_y", "sigma_heading"};

std::array<size_t, kColumns.size()> findColumns(const std::vector<std::string_view>& names,
                                                const fs::path& file) {
  std::array<size_t, kColumns.size()> columns{};
  for (size_t i = 0; i < kColumns.size(); ++i) {
    const auto found = std::find_if(names.begin(), names.end(), [&](std::string_view name) {
      return name.substr(0, name.find(' ')) == kColumns[i];
    });
    if (found == names.end()) {
      throw InputError(fmt::format("{}: no column '{}'; states.csv of `lodeline run` is wanted",
                                   file.string(), kColumns[i]));
    }
    columns[i] = static_cast<size_t>(found - names.begin());
  }
  return columns;
}

std::vector<ClaimedPose> readStates(const fs::path& file) {
  std::ifstream stream(file);
  std::string header, line;
  std::getline(stream, header);
  std::vector<std::string_view> fields;
  csv::split(header, &fields);
  const size_t count = fields.size();
  const auto columns = findColumns(fields, file);
  std::vector<ClaimedPose> poses;
  while (std::getline(stream, line)) {
    csv::split(line, &fields);
    int64_t stamp_ns = 0;
    std::array<double, kColumns.size()> v{};
    // The last line of a run that was killed may be cut off, and frames without a pose have nan.
    bool whole = fields.size() == count && csv::parse(fields[0], &stamp_ns);
    for (size_t i = 0; whole && i < v.size(); ++i)
      whole = csv::parse(fields[columns[i]], &v[i]) && std::isfinite(v[i]);
    if (!whole) continue;
    ClaimedPose pose;
    pose.pose.time = Time::fromNanoseconds(stamp_ns);
    pose.pose.world_from_body = Rigid3(Quat(v[3], v[4], v[5], v[6]).normalized(), Vec3(v[0], v[1], v[2]));
    pose.position_sigma_m = Vec3(v[7], v[8], v[9]);
    pose.rotation_sigma_rad = Vec3(v[10], v[11], v[12]);
    poses.push_back(pose);
  }
  return poses;
}

HeadingBasis readBasis(const fs::path& file) {
  if (!fs::exists(file)) return HeadingBasis::Start;
  try {
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    if (!json.contains("heading")) return HeadingBasis::Start;
    return json["heading"].at("reference").get<std::string>() == "start heading" ? HeadingBasis::Start
                                                                                 : HeadingBasis::North;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: {}; run.json of `lodeline run` is wanted", file.string(), error.what()));
  }
}

const ClaimedPose& nearest(const std::vector<ClaimedPose>& claims, Time time) {
  const auto after = std::lower_bound(claims.begin(), claims.end(), time,
                                      [](const ClaimedPose& claim, Time t) { return claim.pose.time < t; });
  if (after == claims.begin()) return *after;
  const auto before = std::prev(after);
  return after == claims.end() || time - before->pose.time < after->pose.time - time ? *before : *after;
}

// Gathers one kind of error.
class AxesSum {
 public:
  void add(const Vec3& error, const Vec3& sigma) {
    const Eigen::Array3d ratio = error.array().abs() / sigma.array().max(1e-12);
    within_ += (ratio < 3.0).cast<double>();
    squared_ += ratio.square();
    ++count_;
  }
  ClaimedAxes result() const {
    return {100.0 * within_.matrix() / count_, (squared_ / count_).sqrt().matrix()};
  }

 private:
  Eigen::Array3d within_ = Eigen::Array3d::Zero();
  Eigen::Array3d squared_ = Eigen::Array3d::Zero();
  double count_ = 0.0;
};

}  // namespace

RunClaims readClaims(const fs::path& run_folder) {
  RunClaims claims;
  if (!fs::exists(run_folder / "states.csv")) return claims;
  claims.poses = readStates(run_folder / "states.csv");
  claims.basis = readBasis(run_folder / "run.json");
  return claims;
}

ClaimCheck checkClaims(const RunClaims& claims, const Trajectory& reference,
                       const AssociationOptions& association) {
  ClaimCheck check;
  check.basis = claims.basis;
  if (claims.poses.empty() || reference.time_base != TimeBase::Stamps) return check;
  Trajectory estimate;
  for (const ClaimedPose& claim : claims.poses) estimate.poses.push_back(claim.pose);
  const PosePairs pairs = associate(estimate, withZUp(reference), association);
  const std::vector<Rigid3> poses = applyAlignment(alignStarts(claims.basis, pairs), pairs.estimate);
  const Duration offset = Duration::fromSeconds(association.time_offset_s);
  AxesSum position, rotation;
  for (size_t i = 1; i < poses.size(); ++i) {
    const ClaimedPose& claim = nearest(claims.poses, pairs.time[i] - offset);
    position.add(poses[i].translation - pairs.reference[i].translation, claim.position_sigma_m);
    rotation.add(so3::log(poses[i].rotation * pairs.reference[i].rotation.conjugate()),
                 claim.rotation_sigma_rad);
    ++check.poses;
  }
  if (check.poses == 0) return check;
  check.position = position.result();
  check.rotation = rotation.result();
  return check;
}

}  // namespace lodeline

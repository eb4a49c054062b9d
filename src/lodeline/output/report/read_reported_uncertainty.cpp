#include "lodeline/output/report/read_reported_uncertainty.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/output/files/run_table.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 13> kColumns = {"p_x [m]",
                                                  "p_y [m]",
                                                  "p_z [m]",
                                                  "q_w",
                                                  "q_x",
                                                  "q_y",
                                                  "q_z",
                                                  "sigma_p_x [m]",
                                                  "sigma_p_y [m]",
                                                  "sigma_p_z [m]",
                                                  "sigma_theta_x [rad]",
                                                  "sigma_theta_y [rad]",
                                                  "sigma_heading [rad]"};

std::vector<ReportedPose> readPoses(const fs::path& file, Diagnostics* diagnostics) {
  const RunTable table = readRunTable(file, diagnostics);
  std::vector<ReportedPose> poses;
  if (table.rows() == 0) return poses;
  std::array<const std::vector<double>*, kColumns.size()> columns{};
  for (size_t i = 0; i < columns.size(); ++i) {
    const auto column = table.numbers.find(kColumns[i]);
    if (column == table.numbers.end()) {
      throw InputError(
          fmt::format("{}: no column '{}'; states.csv of this version of `lodeline run` is wanted",
                      file.string(), kColumns[i]));
    }
    columns[i] = &column->second;
  }
  for (size_t row = 0; row < table.rows(); ++row) {
    Eigen::Matrix<double, kColumns.size(), 1> v;
    for (size_t i = 0; i < columns.size(); ++i) v[static_cast<Eigen::Index>(i)] = (*columns[i])[row];
    if (!v.allFinite()) continue;  // a frame without a pose
    ReportedPose pose;
    pose.pose.time = Time::fromNanoseconds(table.stamp_ns[row]);
    pose.pose.world_from_body = Rigid3(Quat(v[3], v[4], v[5], v[6]).normalized(), v.head<3>());
    pose.position_sigma_m = v.segment<3>(7);
    pose.rotation_sigma_rad = v.segment<3>(10);
    poses.push_back(pose);
  }
  return poses;
}

HeadingBasis readBasis(const fs::path& file) {
  if (!fs::exists(file)) return HeadingBasis::Start;
  try {
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    if (!json.contains("heading")) return HeadingBasis::Start;
    return headingBasisOf(json["heading"].at("reference").get<std::string>());
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: {}; run.json of `lodeline run` is wanted", file.string(), error.what()));
  }
}

}  // namespace

ReportedUncertainty readReportedUncertainty(const fs::path& run_folder, Diagnostics* diagnostics) {
  ReportedUncertainty claims;
  // States of the refined trajectory, if there is one.
  const bool is_refined = fs::exists(run_folder / "trajectory_refined.tum");
  const fs::path states = run_folder / (is_refined ? "states_refined.csv" : "states.csv");
  if (!fs::exists(states)) return claims;
  claims.poses = readPoses(states, diagnostics);
  claims.basis = readBasis(run_folder / "run.json");
  return claims;
}

ConsistencyCheck checkReported(const fs::path& run_folder, const Trajectory& reference,
                               const AssociationOptions& association, Diagnostics* diagnostics) {
  try {
    return checkConsistency(readReportedUncertainty(run_folder, diagnostics), reference, association);
  } catch (const InputError& error) {
    diagnostics->report(Severity::Warning, "claims_unknown",
                        fmt::format("errors are not compared with claimed sigmas: {}", error.what()));
    return {};
  }
}

}  // namespace lodeline

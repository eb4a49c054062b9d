#include "lodeline/output/files/world_turn.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/csv_fields.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

Quat rotationOf(const WorldTurn& turn) { return so3::exp(turn.angle_rad * Vec3::UnitZ()); }

/// One line of states.csv, accessed by the names of its columns.
class StateRow {
 public:
  StateRow(const std::map<std::string, size_t>& columns, const std::vector<std::string_view>& fields)
      : columns_(columns), fields_(fields.begin(), fields.end()) {}

  double get(const std::string& name) const {
    double value = std::nan("");
    csv::parse(std::string_view(fields_[columns_.at(name)]), &value);
    return value;
  }
  int64_t stamp_ns() const {
    int64_t stamp_ns = 0;
    csv::parse(std::string_view(fields_[0]), &stamp_ns);
    return stamp_ns;
  }
  void set(const std::string& name, double value) {
    fields_[columns_.at(name)] = fmt::format("{:.9g}", value);
  }
  Vec3 vector(const std::array<const char*, 3>& names) const {
    return Vec3(get(names[0]), get(names[1]), get(names[2]));
  }
  void setVector(const std::array<const char*, 3>& names, const Vec3& value) {
    for (int i = 0; i < 3; ++i) set(names[static_cast<size_t>(i)], value[i]);
  }
  std::string line() const { return fmt::format("{}", fmt::join(fields_, ",")); }

 private:
  const std::map<std::string, size_t>& columns_;
  std::vector<std::string> fields_;
};

constexpr std::array kPosition = {"p_x [m]", "p_y [m]", "p_z [m]"};
constexpr std::array kVelocity = {"v_x [m/s]", "v_y [m/s]", "v_z [m/s]"};
constexpr std::array kField = {"field_x [T]", "field_y [T]", "field_z [T]"};
constexpr std::array kPositionSigma = {"sigma_p_x [m]", "sigma_p_y [m]", "sigma_p_z [m]"};
constexpr std::array kRotationSigma = {"sigma_theta_x [rad]", "sigma_theta_y [rad]", "sigma_theta_z [rad]"};
constexpr std::array kVelocitySigma = {"sigma_v_x [m/s]", "sigma_v_y [m/s]", "sigma_v_z [m/s]"};

Vec3 sigmas(const Vec3& variances) { return variances.cwiseMax(0.0).cwiseSqrt(); }

Mat6 poseCovariance(const StateRow& row) {
  Mat6 covariance;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j)
      covariance(i, j) = covariance(j, i) = row.get(fmt::format("cov_pose_{}{}", i, j));
  }
  return covariance;
}

void setPoseCovariance(const Mat6& covariance, StateRow* row) {
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) row->set(fmt::format("cov_pose_{}{}", i, j), covariance(i, j));
  }
  row->setVector(kPositionSigma, sigmas(covariance.diagonal().head<3>()));
  row->setVector(kRotationSigma, sigmas(covariance.diagonal().tail<3>()));
}

void turnCovariances(const WorldTurn& turn, Time time, const Vec3& position_W, const Vec3& velocity_W,
                     StateRow* row) {
  const double north_variance_rad2 = turn.missingVariance_rad2(time);
  setPoseCovariance(turn.applyToCovariance(poseCovariance(*row), time, position_W), row);
  const Mat3 rotation = rotationOf(turn).toRotationMatrix();
  Mat3 of_velocity = row->vector(kVelocitySigma).cwiseAbs2().asDiagonal();
  of_velocity(0, 1) = of_velocity(1, 0) = row->get("cov_v_01");
  const Vec3 velocity_by_turn = Vec3::UnitZ().cross(velocity_W);
  const Mat3 turned = rotation * of_velocity * rotation.transpose() +
                      north_variance_rad2 * velocity_by_turn * velocity_by_turn.transpose();
  row->setVector(kVelocitySigma, sigmas(turned.diagonal()));
  row->set("cov_v_01", turned(0, 1));
  row->set("sigma_heading [rad]",
           std::sqrt(std::pow(row->get("sigma_heading [rad]"), 2) + north_variance_rad2));
}

void turnState(const WorldTurn& turn, StateRow* row) {
  const Vec3 position_W = turn.apply(row->vector(kPosition));
  if (!position_W.allFinite()) return;  // of the attitude filter, which has another north
  const Vec3 velocity_W = turn.apply(row->vector(kVelocity));
  row->setVector(kPosition, position_W);
  row->setVector(kVelocity, velocity_W);
  row->setVector(kField, turn.apply(row->vector(kField)));
  const Quat q = so3::canonical(rotationOf(turn) *
                                Quat(row->get("q_w"), row->get("q_x"), row->get("q_y"), row->get("q_z")));
  row->set("q_w", q.w());
  row->setVector({"q_x", "q_y", "q_z"}, q.vec());
  const double north_rad = row->get("north_from_world [rad]");
  row->set("north_from_world [rad]", std::remainder(north_rad - turn.angle_rad, 2.0 * M_PI));
  turnCovariances(turn, Time::fromNanoseconds(row->stamp_ns()), position_W, velocity_W, row);
}

/// Replaces a text file by its lines after `change`.
void rewrite(const fs::path& file, const std::function<std::string(const std::string&)>& change) {
  std::ifstream before(file);
  if (!before) throw InputError(file.string() + ": cannot be read");
  const fs::path temporary = file.string() + ".turned";
  std::ofstream after = openOutput(temporary);
  std::string line;
  while (std::getline(before, line)) after << change(line) << "\n";
  closeOutput(temporary, &after);
  fs::rename(temporary, file);
}

bool isPose(const std::string& line) { return !line.empty() && line.front() != '#'; }

std::string turnedPose(const std::string& line, const WorldTurn& turn) {
  std::istringstream fields(line);
  std::string stamp;
  Vec3 p;
  Quat q;
  fields >> stamp >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w();
  if (!fields) return line;
  p = turn.apply(p);
  q = so3::canonical(rotationOf(turn) * q);
  return fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", stamp, p.x(), p.y(), p.z(), q.x(),
                     q.y(), q.z(), q.w());
}

}  // namespace

std::optional<WorldTurn> WorldTurn::of(const MagnetometerEstimate& last) {
  if (!last.north_found || !last.north_from_world_rad) return std::nullopt;
  return WorldTurn{*last.north_from_world_rad, last.north_from_world_sigma_rad, last.north_found};
}

Vec3 WorldTurn::apply(const Vec3& vector_W) const { return rotationOf(*this) * vector_W; }

Rigid3 WorldTurn::apply(const Rigid3& world_from_body) const {
  return Rigid3(rotationOf(*this), Vec3::Zero()) * world_from_body;
}

double WorldTurn::missingVariance_rad2(Time time) const {
  return north_found && time < *north_found ? sigma_rad * sigma_rad : 0.0;
}

Mat6 WorldTurn::applyToCovariance(const Mat6& covariance, Time time, const Vec3& position_W) const {
  Mat6 both = Mat6::Zero();
  both.topLeftCorner<3, 3>() = both.bottomRightCorner<3, 3>() = rotationOf(*this).toRotationMatrix();
  Eigen::Matrix<double, 6, 1> by_turn;
  by_turn << Vec3::UnitZ().cross(position_W), Vec3::UnitZ();
  return both * covariance * both.transpose() + missingVariance_rad2(time) * by_turn * by_turn.transpose();
}

void turnTrajectoryFile(const fs::path& file, const WorldTurn& turn, std::optional<size_t> most) {
  size_t poses = 0;
  rewrite(file, [&](const std::string& line) {
    if (!isPose(line) || (most && poses++ >= *most)) return line;
    return turnedPose(line, turn);
  });
}

void turnStateFiles(const fs::path& folder, const std::string& suffix, const WorldTurn& turn) {
  turnTrajectoryFile(folder / ("trajectory" + suffix + ".tum"), turn);
  std::map<std::string, size_t> columns;
  std::vector<std::string_view> fields;
  rewrite(folder / ("states" + suffix + ".csv"), [&](const std::string& line) {
    csv::split(line, &fields);
    if (columns.empty()) {
      for (size_t i = 0; i < fields.size(); ++i) columns[std::string(fields[i])] = i;
      return line;
    }
    StateRow row(columns, fields);
    turnState(turn, &row);
    return row.line();
  });
}

}  // namespace lodeline

#include "lodeline/inspection/robots/current_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kWindow_s = 8.0;
constexpr size_t kRowsPerWindow = 60, kFewestInWindow = 15, kMostWindows = 40;
constexpr int kFewestReadings = 100;
/// Current that must change for a channel to be compared, A.
constexpr double kLeastChange_A = 0.1;

using Window = std::vector<MagnetometerSample>;

std::vector<Window> windowsOf(const std::vector<MagnetometerSample>& field) {
  std::vector<Window> windows;
  const Duration length = Duration::fromSeconds(kWindow_s);
  for (size_t begin = 0; begin < field.size();) {
    size_t end = begin;
    while (end < field.size() && field[end].time < field[begin].time + length) ++end;
    const size_t every = std::max<size_t>(1, (end - begin) / kRowsPerWindow);
    Window window;
    for (size_t i = begin; i < end; i += every) window.push_back(field[i]);
    if (window.size() >= kFewestInWindow) windows.push_back(std::move(window));
    begin = std::max(end, begin + 1);
  }
  const size_t keep = std::max<size_t>(1, windows.size() / kMostWindows);
  std::vector<Window> chosen;
  for (size_t i = 0; i < windows.size(); i += keep) chosen.push_back(std::move(windows[i]));
  return chosen;
}

/// Currents at any time, between two readings that are not far apart.
class CurrentCourse {
 public:
  CurrentCourse(const std::vector<CurrentSample>& samples, double time_offset_s) : samples_(samples) {
    std::stable_sort(samples_.begin(), samples_.end(),
                     [](const CurrentSample& a, const CurrentSample& b) { return a.time < b.time; });
    for (CurrentSample& sample : samples_) sample.time = sample.time + Duration::fromSeconds(time_offset_s);
  }

  std::optional<Eigen::VectorXd> at(Time time) const {
    const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                        [](const CurrentSample& sample, Time t) { return sample.time < t; });
    if (after == samples_.end() || after == samples_.begin()) return std::nullopt;
    const CurrentSample& before = *(after - 1);
    const double gap_s = (after->time - before.time).seconds();
    constexpr double kLongestGap_s = 2.0;
    if (gap_s > kLongestGap_s) return std::nullopt;
    const double share = gap_s > 0.0 ? (time - before.time).seconds() / gap_s : 0.0;
    Eigen::VectorXd result(static_cast<Eigen::Index>(before.currents_A.size()));
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      const auto place = static_cast<size_t>(i);
      result[i] = before.currents_A[place] + share * (after->currents_A[place] - before.currents_A[place]);
    }
    return result;
  }

 private:
  std::vector<CurrentSample> samples_;
};

/// Normal equations of the hard iron and the fields of the currents.
struct Equations {
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;
  double squares = 0.0;
  int readings = 0;

  explicit Equations(Eigen::Index unknowns)
      : normal(Eigen::MatrixXd::Zero(unknowns, unknowns)), right(Eigen::VectorXd::Zero(unknowns)) {}

  /// The solution with the first `unknowns`, and the rms of the remainder of a reading.
  std::pair<Eigen::VectorXd, double> solve(Eigen::Index unknowns) const {
    Eigen::MatrixXd part = normal.topLeftCorner(unknowns, unknowns);
    const Eigen::VectorXd b = right.head(unknowns);
    // Without rotation the hard iron, and without a change a current, is not observable.
    part.diagonal().array() += 1e-6 * part.diagonal().maxCoeff() + 1e-30;
    const Eigen::VectorXd x = part.ldlt().solve(b);
    const double left = squares - 2.0 * x.dot(b) + x.dot(normal.topLeftCorner(unknowns, unknowns) * x);
    return {x, std::sqrt(std::max(0.0, left) / readings)};
  }
};

Equations equationsOf(const std::vector<Window>& windows, const CurrentCourse& course, size_t channels,
                      const Rig& rig, double tesla_per_unit, const InertialPath& path) {
  const auto unknowns = static_cast<Eigen::Index>(3 + 3 * channels);
  Equations sum(unknowns);
  const Mat3 body_from_magnetometer = rig.magnetometer->body_from_magnetometer.rotation.toRotationMatrix();
  const Duration offset = Duration::fromSeconds(rig.magnetometer->time_offset_to_imu_s);
  for (const Window& window : windows) {
    std::vector<Eigen::MatrixXd> jacobians;
    std::vector<Vec3> fields;
    Eigen::MatrixXd mean_jacobian = Eigen::MatrixXd::Zero(3, unknowns);
    Vec3 mean_field = Vec3::Zero();
    for (const MagnetometerSample& sample : window) {
      const std::optional<Mat3> attitude = path.attitude(sample.time + offset);
      const std::optional<Eigen::VectorXd> currents = course.at(sample.time + offset);
      if (!attitude || !currents) continue;
      const Mat3 turned = *attitude * body_from_magnetometer;
      Eigen::MatrixXd jacobian(3, unknowns);
      jacobian.leftCols<3>() = turned;
      for (size_t i = 0; i < channels; ++i)
        jacobian.middleCols<3>(static_cast<Eigen::Index>(3 + 3 * i)) =
            (*currents)[static_cast<Eigen::Index>(i)] * turned;
      fields.emplace_back(turned * (tesla_per_unit * sample.field_M));
      mean_field += fields.back();
      mean_jacobian += jacobian;
      jacobians.push_back(std::move(jacobian));
    }
    if (fields.size() < kFewestInWindow) continue;
    const auto count = static_cast<double>(fields.size());
    for (size_t i = 0; i < fields.size(); ++i) {
      const Eigen::MatrixXd jacobian = jacobians[i] - mean_jacobian / count;
      const Vec3 deviation = fields[i] - mean_field / count;
      sum.normal += jacobian.transpose() * jacobian;
      sum.right += jacobian.transpose() * deviation;
      sum.squares += deviation.squaredNorm();
    }
    sum.readings += static_cast<int>(fields.size());
  }
  return sum;
}

/// Largest change of each channel.
std::vector<double> changesOf(const std::vector<CurrentSample>& currents, size_t channels) {
  std::vector<double> changes;
  for (size_t i = 0; i < channels; ++i) {
    const auto [least, greatest] = std::minmax_element(
        currents.begin(), currents.end(),
        [i](const CurrentSample& a, const CurrentSample& b) { return a.currents_A[i] < b.currents_A[i]; });
    changes.push_back(greatest->currents_A[i] - least->currents_A[i]);
  }
  return changes;
}

}  // namespace

std::optional<CurrentComparison> compareCurrents(const std::vector<MagnetometerSample>& field,
                                                 const std::vector<CurrentSample>& currents, const Rig& rig,
                                                 double tesla_per_unit, const InertialPath& path) {
  if (currents.empty() || field.empty()) return std::nullopt;
  const size_t channels = currents.front().currents_A.size();
  const std::vector<double> changes = changesOf(currents, channels);
  if (std::none_of(changes.begin(), changes.end(), [](double change) { return change > kLeastChange_A; }))
    return std::nullopt;
  const std::vector<Window> windows = windowsOf(field);
  const double stated_s = rig.currents->time_offset_to_imu_s;
  const auto equations = [&](double shift_s) {
    return equationsOf(windows, CurrentCourse(currents, stated_s + shift_s), channels, rig, tesla_per_unit,
                       path);
  };
  const Equations recorded = equations(0.0);
  if (recorded.readings < kFewestReadings) return std::nullopt;
  const auto unknowns = static_cast<Eigen::Index>(3 + 3 * channels);
  const auto [fields, explained] = recorded.solve(unknowns);
  CurrentComparison result;
  result.readings = recorded.readings;
  result.scatter_T = recorded.solve(3).second;
  result.explained_scatter_T = result.scatter_at_offset_T = explained;
  const Eigen::MatrixXd covariance = (recorded.normal + 1e-30 * Eigen::MatrixXd::Identity(unknowns, unknowns))
                                         .ldlt()
                                         .solve(Eigen::MatrixXd::Identity(unknowns, unknowns));
  for (size_t i = 0; i < channels; ++i) {
    if (changes[i] <= kLeastChange_A) continue;
    const auto place = static_cast<Eigen::Index>(3 + 3 * i);
    const double variance = covariance.diagonal().segment<3>(place).mean();
    result.channels.push_back({i < rig.currents->channels.size() ? rig.currents->channels[i] : "",
                               fields.segment<3>(place), explained * std::sqrt(std::max(0.0, variance))});
  }
  constexpr int kSteps = 10;
  constexpr double kStep_s = 0.05;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const Equations shifted = equations(i * kStep_s);
    if (2 * shifted.readings < recorded.readings) continue;
    const double scatter = shifted.solve(unknowns).second;
    if (scatter >= result.scatter_at_offset_T) continue;
    result.scatter_at_offset_T = scatter;
    result.time_offset_s = i * kStep_s;
  }
  return result;
}

}  // namespace lodeline

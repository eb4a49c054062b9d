#include "lodeline/magnetometer/calibration/currents/current_report.h"

#include <fmt/format.h>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

nlohmann::ordered_json components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::string residualRow(const char* name, const CurrentResidual& residual) {
  return fmt::format("  {:<20}{:8.3f} uT {:8.2f} degrees of heading, {:.2f} at worst\n", name,
                     1e6 * residual.rms_T, residual.heading_rms_rad / kDegree,
                     residual.heading_largest_rad / kDegree);
}

nlohmann::ordered_json residualJson(const CurrentResidual& residual) {
  return {{"rms_T", residual.rms_T},
          {"heading_rms_deg", residual.heading_rms_rad / kDegree},
          {"heading_largest_deg", residual.heading_largest_rad / kDegree}};
}

std::string channelRows(const CurrentFit& fit) {
  std::string text = fmt::format("  {:<20}{:>8} {:>8} {:>8}    {:>6}  {:>8}  {:>8}\n", "channel (uT/A)", "x",
                                 "y", "z", "sigma", "up to A", "up to uT");
  for (const CurrentChannel& channel : fit.channels) {
    const Vec3 k = 1e6 * channel.field_T_per_A;
    text += fmt::format("  {:<20}{:8.4f} {:8.4f} {:8.4f} +- {:6.4f}  {:8.2f}  {:8.2f}{}\n", channel.name,
                        k.x(), k.y(), k.z(), 1e6 * channel.sigma_T_per_A, channel.largest_A,
                        1e6 * channel.largestField_T(), channel.isIdentified() ? "" : "  not identified");
  }
  return text;
}

/// A name without the quotes that would end a title.
std::string titleOf(std::string name) {
  std::erase(name, '\'');
  return name;
}

}  // namespace

std::string currentText(const CurrentCalibrationResult& result) {
  const CurrentFit& fit = result.fit;
  std::string text = fit.verdict + "\n" + channelRows(fit);
  text += residualRow("without compensation", fit.without) + residualRow("with compensation", fit.with);
  text += fmt::format("  {:<20}{:.2f} degrees of heading in means over a second\n", "of that",
                      fit.correlated_rms_rad / kDegree);
  text += fmt::format("  {:<20}{:.0f} +- {:.0f} ms, stamps of the currents before those of the field{}\n",
                      "lag", 1e3 * fit.measured_lag_s, 1e3 * fit.lag_sigma_s,
                      fit.lag_s == 0.0 ? " (not significant, not used)" : "");
  text += fit.is_motion_known ? fmt::format("  {:<20}up to {:.2f} degrees by the gyroscope\n", "motion",
                                            fit.turned_rad / kDegree)
                              : fmt::format("  {:<20}unknown: no gyroscope\n", "motion");
  text += fmt::format("  {:<20}{} means of readings, {:.1f} % rejected\n", "used", fit.readings,
                      100.0 * fit.rejected_share);
  text += fmt::format("  {:<20}{:.4f} uT/A each component, with 2 % for what changes from day to day\n",
                      "sigma for a run", 1e6 * fit.field_sigma_T_per_A);
  if (fit.heading_source != "accelerometer")
    text += "  headings are for a dip of 60 degrees: no accelerometer tells the vertical\n";
  if (result.check) {
    text += "earlier calibration: " + result.check->verdict + "\n";
    text += residualRow("with the earlier one", result.check->with);
  }
  return text;
}

nlohmann::ordered_json currentJson(const CurrentCalibrationResult& result) {
  const CurrentFit& fit = result.fit;
  nlohmann::ordered_json json;
  json["verdict"] = fit.verdict;
  json["channels"] = nlohmann::ordered_json::array();
  for (const CurrentChannel& channel : fit.channels) {
    nlohmann::ordered_json& entry = json["channels"].emplace_back();
    entry["name"] = channel.name;
    entry["field_T_per_A"] = components(channel.field_T_per_A);
    entry["sigma_T_per_A"] = channel.sigma_T_per_A;
    entry["largest_A"] = channel.largest_A;
    entry["largest_field_T"] = channel.largestField_T();
    entry["identified"] = channel.isIdentified();
    if (!channel.isIdentified()) entry["objection"] = channel.objection;
  }
  json["field_sigma_T_per_A"] = fit.field_sigma_T_per_A;
  json["without_compensation"] = residualJson(fit.without);
  json["with_compensation"] = residualJson(fit.with);
  json["heading_of_second_means_deg"] = fit.correlated_rms_rad / kDegree;
  json["heading_source"] = fit.heading_source;
  json["lag_measured_s"] = fit.measured_lag_s;
  json["lag_sigma_s"] = fit.lag_sigma_s;
  json["lag_used"] = fit.lag_s != 0.0;
  json["motion_known"] = fit.is_motion_known;
  json["turned_deg"] = fit.turned_rad / kDegree;
  json["readings"] = fit.readings;
  json["rejected_percent"] = 100.0 * fit.rejected_share;
  if (!result.check) return json;
  nlohmann::ordered_json& check = json["check"];
  check["verdict"] = result.check->verdict;
  check["cables_moved"] = result.check->is_moved;
  check["with_earlier_calibration"] = residualJson(result.check->with);
  check["chi_square"] = result.check->contradiction.chi_square;
  check["degrees_of_freedom"] = result.check->contradiction.degrees_of_freedom;
  for (size_t i = 0; i < fit.channels.size(); ++i)
    check["differences_T_per_A"][fit.channels[i].name] = components(result.check->differences_T_per_A[i]);
  return json;
}

gnuplot::Figure currentFigure(const CurrentCalibrationResult& result) {
  const CurrentFit& fit = result.fit;
  gnuplot::Figure figure;
  figure.name = "currents";
  gnuplot::Curve before, after;
  std::vector<gnuplot::Curve> currents(fit.channels.size());
  const Eigen::MatrixXd fields_uT = 1e6 * fit.currents_A * fit.fields_T_per_A();
  for (Eigen::Index row = 0; row < fit.currents_A.rows(); ++row) {
    const double time_s = fit.table.times_s[row];
    if (fit.lines.weights[row] > 0.0) {
      before.points.push_back({time_s, (fit.lines.residuals.row(row) + fields_uT.row(row)).norm()});
      after.points.push_back({time_s, fit.lines.residuals.row(row).norm()});
    }
    for (size_t i = 0; i < currents.size(); ++i)
      currents[i].points.push_back({time_s, fit.currents_A(row, static_cast<Eigen::Index>(i))});
  }
  std::string& text = figure.commands;
  text = gnuplot::dataBlock("before", before) + gnuplot::dataBlock("after", after);
  for (size_t i = 0; i < currents.size(); ++i)
    text += gnuplot::dataBlock("current" + std::to_string(i), currents[i]);
  text +=
      "set multiplot layout 2,1\nset xlabel 'time (s)'\nset ylabel 'field of currents (uT)'\nset key top "
      "right\n"
      "plot $before with lines lw 1.5 title 'without compensation', $after with lines lw 1.5 title 'with "
      "compensation'\nset ylabel 'current (A)'\nplot ";
  for (size_t i = 0; i < currents.size(); ++i) {
    text += fmt::format("{}$current{} with lines lw 1.5 title '{}' noenhanced", i ? ", " : "", i,
                        titleOf(fit.channels[i].name));
  }
  text += "\nunset multiplot\n";
  return figure;
}

}  // namespace lodeline

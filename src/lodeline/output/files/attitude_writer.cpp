#include "lodeline/output/files/attitude_writer.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>

#include "lodeline/util/angles.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {}  // namespace

double azimuth_deg(const Quat& world_from_body) {
  const Vec3 ahead_W = world_from_body * Vec3::UnitX();
  const double azimuth = kDegreesPerRadian * std::atan2(ahead_W.x(), ahead_W.y());
  return azimuth < 0.0 ? azimuth + 360.0 : azimuth;
}

AttitudeWriter::AttitudeWriter(const std::filesystem::path& folder)
    : folder_(folder), csv_(openOutput(folder / "attitude.csv")), tum_(openOutput(folder / "attitude.tum")) {
  csv_ << "#timestamp [ns],status,q_w,q_x,q_y,q_z,heading [deg],sigma_heading [deg],b_g_x [rad/s],b_g_y "
          "[rad/s],b_g_z [rad/s],at_rest\n";
  tum_ << "# timestamp [s] x y z qx qy qz qw; the position is not known\n";
}

void AttitudeWriter::write(const AttitudeEstimate& estimate) {
  const Quat& q = estimate.world_from_body;
  const Vec3& b = estimate.gyroscope_bias_B;
  const int64_t ns = estimate.time.nanoseconds();
  fmt::print(csv_, "{},{},{:.9f},{:.9f},{:.9f},{:.9f},{:.4f},{:.4f},{:.9g},{:.9g},{:.9g},{}\n", ns,
             toString(estimate.status), q.w(), q.x(), q.y(), q.z(), azimuth_deg(q),
             kDegreesPerRadian * estimate.heading_sigma_rad, b.x(), b.y(), b.z(), estimate.at_rest ? 1 : 0);
  fmt::print(tum_, "{} 0 0 0 {:.9f} {:.9f} {:.9f} {:.9f}\n", secondsText(estimate.time), q.x(), q.y(), q.z(),
             q.w());
  if (!first_) first_ = estimate.time;
  last_ = estimate;
  ++count_;
  ++statuses_[estimate.status];
  at_rest_ += estimate.at_rest ? 1 : 0;
}

void AttitudeWriter::finish() {
  closeOutput(folder_ / "attitude.csv", &csv_);
  closeOutput(folder_ / "attitude.tum", &tum_);
}

std::string AttitudeWriter::text(const std::string& north) const {
  if (count_ == 0) return "";
  std::string text = fmt::format("attitude      {} estimates over {:.1f} s, heading from {}\nstatus        ",
                                 count_, (last_.time - *first_).seconds(), north);
  for (const auto& [status, count] : statuses_) {
    text += fmt::format("{} {:.1f} %  ", toString(status), 100.0 * count / count_);
  }
  const Vec3 bias = kDegreesPerRadian * last_.gyroscope_bias_B;
  text += fmt::format(
      "\nat rest       {:.1f} %\nend           heading {:.1f} deg, sigma {:.1f} deg\n"
      "gyroscope     bias {:.3f} {:.3f} {:.3f} deg/s\n",
      100.0 * at_rest_ / count_, azimuth_deg(last_.world_from_body),
      kDegreesPerRadian * last_.heading_sigma_rad, bias.x(), bias.y(), bias.z());
  return text;
}

nlohmann::ordered_json AttitudeWriter::json(const std::string& north) const {
  nlohmann::ordered_json json = {{"heading_from", north}, {"estimates", count_}};
  if (count_ == 0) return json;
  json["duration_s"] = (last_.time - *first_).seconds();
  json["at_rest_share"] = static_cast<double>(at_rest_) / count_;
  for (const auto& [status, count] : statuses_) {
    json["status_share"][toString(status)] = static_cast<double>(count) / count_;
  }
  json["end"] = {{"heading_deg", azimuth_deg(last_.world_from_body)},
                 {"heading_sigma_deg", kDegreesPerRadian * last_.heading_sigma_rad}};
  const Vec3& bias = last_.gyroscope_bias_B;
  json["gyroscope_bias_rad_per_s"] = {bias.x(), bias.y(), bias.z()};
  return json;
}

}  // namespace lodeline

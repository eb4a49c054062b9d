#include "lodeline/output/report/page/test_run.h"

#include <fmt/format.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/output/files/landmark_writer.h"
#include "lodeline/output/files/magnetometer_writer.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/output/files/timing_writer.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline::test {
namespace {

constexpr int64_t kStart_ns = 1700000000000000000;

Time timeAt(double t_s) { return Time::fromNanoseconds(kStart_ns) + Duration::fromSeconds(t_s); }

Rigid3 poseAt(double t_s) {
  const double turn = 0.2 * t_s;
  const double radius_m = 2.0 + 0.05 * t_s;
  return {Quat(Eigen::AngleAxisd(turn + M_PI / 2.0, Vec3::UnitZ())),
          Vec3(radius_m * std::cos(turn), radius_m * std::sin(turn), -0.05 * t_s)};
}

FrameEstimate estimateAt(int i, double t_s) {
  FrameEstimate estimate;
  estimate.time = timeAt(t_s);
  estimate.status = i % 50 == 49 ? Status::Inertial : Status::Tracking;
  estimate.state.world_from_body = poseAt(t_s);
  estimate.covariance.diagonal().setConstant(1e-4 * (1.0 + t_s));
  estimate.tracks = 150 + i % 30;
  estimate.landmarks = 80 + i % 20;
  estimate.reprojection_rms_sigmas = 0.5;
  MagnetometerEstimate& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  magnetometer.status = i % 20 == 19 ? MagnetometerStatus::Norm : MagnetometerStatus::Used;
  magnetometer.heading_reference = HeadingReference::True;
  magnetometer.heading_sigma_rad = 0.01;
  magnetometer.field_W = Vec3(-2.7e-6, 24e-6, -38.6e-6);
  magnetometer.offset_B = Vec3(1e-7, -2e-7, 5e-8);
  return estimate;
}

std::vector<MapPoint> landmarksAt(int i, const TestRun& run, double t_s) {
  std::vector<MapPoint> points;
  for (int k = 0; k < run.landmarks_per_frame; ++k) {
    const Vec3 offset(std::sin(1.0 * i + k), std::cos(2.0 * i + k), std::sin(3.0 * i));
    points.push_back({i * run.landmarks_per_frame + k, poseAt(t_s).translation + 1.5 * offset, 4});
  }
  return points;
}

FramePacket packetAt(double t_s) {
  FramePacket packet;
  packet.time = timeAt(t_s);
  const Vec3 field_W(-2.7e-6, 24e-6, -38.6e-6);
  packet.readings.of<MagnetometerSample>().push_back({packet.time, poseAt(t_s).rotation.inverse() * field_W});
  return packet;
}

void writePictures(const std::filesystem::path& folder, const TestRun& run) {
  std::filesystem::create_directories(folder);
  cv::RNG random(1);
  for (int i = 0; i < run.pictures; ++i) {
    const double t_s = i * run.frames / run.rate_hz / run.pictures;
    cv::Mat picture(run.picture_width_px * 5 / 8, run.picture_width_px, CV_8U);
    random.fill(picture, cv::RNG::NORMAL, 110.0, 12.0);
    cv::imwrite((folder / fmt::format("{}.jpg", timeAt(t_s).nanoseconds())).string(), picture,
                {cv::IMWRITE_JPEG_QUALITY, 65});
  }
}

/// A ledger of five pairs, two of them loops, and two observations of a tag. The keyframes in the map are
/// half a metre east of the odometry.
void writeMap(const std::filesystem::path& folder, const TestRun& run) {
  const auto stamp = [](double t_s) { return timeAt(t_s).nanoseconds(); };
  const auto row = [&](double new_s, double old_s, const char* old_dive, const char* end) {
    return fmt::format("{},{},dive,{},{}\n", stamp(new_s), stamp(old_s), old_dive, end);
  };
  const std::string numbers = ",0.2,0.8,1.5,0.1,0,0,2.0,0.01,0.01,0.01";
  const std::string no_pose = ",0,0,0,nan,nan,nan,nan,nan,nan,nan";
  std::string ledger =
      "#new_time [ns],old_time [ns],new_dive,old_dive,source,status,reason,matches,inliers,covered_share,"
      "rms [sigma],mahalanobis_squared,dx [m],dy [m],dz [m],turn [deg],sigma_dx [m],sigma_dy [m],"
      "sigma_dz [m]\n";
  ledger += row(10, 2, "dive", ("geometry,accepted,,60,40" + numbers).c_str());
  ledger += row(11, 4, run.old_dive, ("appearance,accepted,,50,30" + numbers).c_str());
  ledger += row(6, 1, "dive", ("geometry,candidate,\"12 matches, 15 needed\",12,0" + no_pose).c_str());
  ledger += row(7, 1, "dive", ("geometry,candidate,\"9 matches, 15 needed\",9,0" + no_pose).c_str());
  ledger += row(8, 3, "dive", ("tag,refused,tag 7 hangs 3.20 m away,1,0" + no_pose).c_str());
  writeOutput(folder / "loops.csv", ledger);
  std::string poses = "#t x y z qx qy qz qw\n";
  for (double t_s = 0.0; t_s < run.frames / run.rate_hz; t_s += 1.0) {
    const Vec3 p = poseAt(t_s).translation + 0.5 * Vec3::UnitX();
    const Quat& q = poseAt(t_s).rotation;
    poses += fmt::format("{}.{:09} {:.6f} {:.6f} {:.6f} {} {} {} {}\n", stamp(t_s) / 1'000'000'000,
                         stamp(t_s) % 1'000'000'000, p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
  writeOutput(folder / "keyframes_map.tum", poses);
  writeOutput(folder / "control.csv",
              "#name,kind,time [ns],east [m],north [m],up [m],sigma_east [m],sigma_north [m],sigma_up "
              "[m],chi_squared,blunder\n" +
                  fmt::format("tag 3,tag,{},0.02,-0.01,0.005,0.02,0.02,0.02,1.3,no\n", stamp(3)) +
                  fmt::format("\"tag 7, old\",tag,{},3.2,0.1,0.0,0.02,0.02,0.02,812.0,yes\n", stamp(8)));
}

}  // namespace

void writeTestRun(const std::filesystem::path& folder, const TestRun& run) {
  std::filesystem::create_directories(folder);
  RunDescription description;
  description.data = "dive";
  description.cameras = {"cam0", "cam1"};
  description.camera_rate_hz = run.rate_hz;
  description.imu_rate_hz = 200.0;
  MagnetometerCalibration calibration;
  calibration.is_calibrated = true;
  calibration.field_strength_T = 50e-6;  // at home
  description.magnetometer = calibration;
  description.site_field_W = Vec3(-2.7e-6, 24e-6, -38.6e-6);
  RunSummary summary(description);
  StateWriter states(folder);
  LandmarkWriter landmarks(folder);
  TimingWriter timings(folder);
  MagnetometerWriter magnetometer(folder, calibration);
  StageTimes times;
  for (int i = 0; i < run.frames; ++i) {
    const double t_s = i / run.rate_hz;
    const FrameEstimate estimate = estimateAt(i, t_s);
    states.write(estimate);
    summary.add(estimate);
    landmarks.write(landmarksAt(i, run, t_s));
    magnetometer.write(packetAt(t_s));
    times.front_end_s += 0.006;
    times.estimator_s += 0.011;
    timings.write(estimate.time, times, 0.0);
  }
  writePictures(folder / "pictures", run);
  if (run.map) writeMap(folder, run);
  Diagnostics diagnostics;
  diagnostics.report(Severity::Warning, "test", "a name with </script> in it");
  writeOutput(folder / "run.json", summary.json(diagnostics));
  writeOutput(folder / "config.yaml", "window:\n  keyframes: 7\n");
}

void writeTestReference(const std::filesystem::path& file, const TestRun& run) {
  std::ofstream stream(file);
  for (int i = 0; i / 10.0 < run.frames / run.rate_hz; ++i) {
    const Rigid3 pose = poseAt(i / 10.0);
    const Vec3& p = pose.translation;
    const Quat& q = pose.rotation;
    const int64_t ns = timeAt(i / 10.0).nanoseconds();
    stream << fmt::format("{}.{:09} {} {} {} {} {} {} {}\n", ns / 1000000000, ns % 1000000000, p.x(), p.y(),
                          p.z() + 0.1, q.x(), q.y(), q.z(), q.w());
  }
}

}  // namespace lodeline::test

#include "lodeline/io/euroc/test_recording.h"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

namespace lodeline {
namespace {

constexpr int64_t kEpoch_ns = 1'403'636'579'000'000'000;
constexpr const char* kIdentity =
    "T_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";

constexpr const char* kImuYaml =
    "rate_hz: 200\n"
    "gyroscope_noise_density: 1.7e-4\ngyroscope_random_walk: 2e-5\n"
    "accelerometer_noise_density: 2e-3\naccelerometer_random_walk: 3e-3\n";

constexpr const char* kCameraYaml =
    "rate_hz: 20\nresolution: [16, 12]\ncamera_model: pinhole\nintrinsics: [20, 21, 8, 6]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.1, 0.01, 1e-4, 2e-4]\n";

}  // namespace

Time testTime(double seconds) { return Time::fromNanoseconds(kEpoch_ns) + Duration::fromSeconds(seconds); }

std::string testStamp(double seconds) { return fmt::format("{}", testTime(seconds).nanoseconds()); }

TestRecording::TestRecording() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lodeline_test_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
  folder_ = pattern;
  writeImu();
  writeMagnetometer();
  writeCamera(0);
  writeCamera(1);
}

TestRecording::~TestRecording() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path TestRecording::image(int camera, double time_s) const {
  return path(fmt::format("cam{}/data/{}.png", camera, testStamp(time_s)));
}

void TestRecording::write(const std::string& below, const std::string& text) const {
  std::filesystem::create_directories(path(below).parent_path());
  std::ofstream(path(below), std::ios::binary) << text;
}

std::string TestRecording::read(const std::string& below) const {
  std::ostringstream text;
  text << std::ifstream(path(below), std::ios::binary).rdbuf();
  return text.str();
}

void TestRecording::replace(const std::string& below, const std::string& from, const std::string& to) const {
  std::string text = read(below);
  const size_t place = text.find(from);
  if (place == std::string::npos) throw std::runtime_error("no '" + from + "' in " + below);
  write(below, text.replace(place, from.size(), to));
}

void TestRecording::writeImu() const {
  std::string csv = "#timestamp [ns],w_x,w_y,w_z [rad s^-1],a_x,a_y,a_z [m s^-2]\n";
  for (int i = 0; i <= 400; ++i) {
    const double time_s = 0.5 + 0.005 * i;
    // Changing values, because an accelerometer with constant readings would be rejected as stuck.
    csv += fmt::format("{},{:.3f},0,0,{:.3f},0.2,9.8\n", testStamp(time_s), time_s, 0.1 + 0.001 * (i % 3));
  }
  write("imu0/data.csv", csv);
  write("imu0/sensor.yaml", std::string("sensor_type: imu\n") + kIdentity + kImuYaml);
}

void TestRecording::writeMagnetometer() const {
  std::string csv = "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
  for (int i = 0; i <= 100; ++i) csv += testStamp(0.5 + 0.02 * i) + ",2e-5,0,-4e-5\n";
  write("mag0/data.csv", csv);
  write("mag0/sensor.yaml", std::string(kIdentity) + "rate_hz: 50\nmagnetometer_noise_density: 1e-8\n");
}

void TestRecording::writeCamera(int camera) const {
  const std::string name = fmt::format("cam{}", camera);
  std::string csv = "#timestamp [ns],filename\n";
  std::filesystem::create_directories(path(name + "/data"));
  for (int i = 0; i <= 20; ++i) {
    const std::string stamp = testStamp(1.0 + 0.05 * i);
    csv += stamp + "," + stamp + ".png\n";
    cv::Mat pixels(12, 16, CV_8UC1, cv::Scalar(10 * camera + i));
    cv::imwrite((path(name + "/data") / (stamp + ".png")).string(), pixels);
  }
  write(name + "/data.csv", csv);
  write(name + "/sensor.yaml", std::string("sensor_type: camera\n") + kIdentity + kCameraYaml);
}

}  // namespace lodeline

#include "apps/lodeline/tests/test_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/types.h"

namespace lodeline::test {
namespace {

constexpr int kWidth_px = 320;
constexpr int kHeight_px = 240;
constexpr double kFocal_px = 250.0;
constexpr double kBaseline_m = 0.12;
constexpr int64_t kStart_ns = 1'000'000'000'000;
constexpr int64_t kImagePeriod_ns = 50'000'000;
constexpr int64_t kImuPeriod_ns = 5'000'000;
constexpr int64_t kImuLead_ns = 500'000'000;

const Vec3 kRoomHalfSize_m(3.0, 2.2, 1.6);
const Vec3 kGyroscopeBias_B(0.01, -0.008, 0.005);
const Vec3 kAccelerometerBias_B(0.05, 0.03, -0.04);

double seconds(int64_t stamp_ns) { return 1e-9 * static_cast<double>(stamp_ns - kStart_ns); }

Vec3 positionAt(double t) {
  return {0.30 * std::sin(1.3 * t), 0.40 * std::sin(1.9 * t + 0.3), 0.20 * std::sin(2.3 * t)};
}
Vec3 accelerationAt(double t) {
  return {-0.30 * 1.3 * 1.3 * std::sin(1.3 * t), -0.40 * 1.9 * 1.9 * std::sin(1.9 * t + 0.3),
          -0.20 * 2.3 * 2.3 * std::sin(2.3 * t)};
}
Quat attitudeAt(double t) {
  return so3::exp(Vec3(0.06 * std::sin(2.0 * t), 0.08 * std::sin(1.7 * t), 0.15 * std::sin(1.1 * t)));
}
Vec3 angularVelocityAt(double t) {
  constexpr double kStep_s = 1e-4;
  return so3::log(attitudeAt(t - kStep_s).conjugate() * attitudeAt(t + kStep_s)) / (2.0 * kStep_s);
}

/// The camera looks along the body's x axis; camera 1 is to the right of camera 0.
Rigid3 bodyFromCamera(int camera) {
  Mat3 rotation;
  rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return Rigid3(Quat(rotation), Vec3(0.05, 0.5 * kBaseline_m - kBaseline_m * camera, 0.02));
}

/// Grey texture at several scales, 100 px/m, periodic without visible seams.
cv::Mat wallTexture() {
  constexpr int kSize_px = 1024;
  cv::RNG random(7);
  cv::Mat sum = cv::Mat::zeros(kSize_px, kSize_px, CV_32F);
  for (const int cell_px : {4, 8, 16, 32}) {
    cv::Mat noise(kSize_px / cell_px, kSize_px / cell_px, CV_32F);
    random.fill(noise, cv::RNG::UNIFORM, -40.0, 40.0);
    cv::Mat large;
    cv::resize(noise, large, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += large;
  }
  sum += 128.0;
  return sum;
}

float sample(const cv::Mat& texture, double x, double y) {
  const double x0 = std::floor(x);
  const double y0 = std::floor(y);
  const float fx = static_cast<float>(x - x0);
  const float fy = static_cast<float>(y - y0);
  const int mask = texture.cols - 1;
  const int column = static_cast<int>(x0) & mask;
  const int row = static_cast<int>(y0) & mask;
  const float* upper = texture.ptr<float>(row);
  const float* lower = texture.ptr<float>((row + 1) & mask);
  const int next = (column + 1) & mask;
  return (1 - fy) * ((1 - fx) * upper[column] + fx * upper[next]) +
         fy * ((1 - fx) * lower[column] + fx * lower[next]);
}

/// Grey value of the wall at the first intersection of a ray from inside the room.
float wallGrey(const cv::Mat& texture, const Vec3& origin_W, const Vec3& direction_W) {
  double range = INFINITY;
  int wall = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double limit = std::copysign(kRoomHalfSize_m[axis], direction_W[axis]);
    const double candidate = (limit - origin_W[axis]) / direction_W[axis];
    if (candidate < range) {
      range = candidate;
      wall = axis;
    }
  }
  constexpr double kScale_px_per_m = 100.0;
  const Vec3 hit = origin_W + range * direction_W;
  const double side = direction_W[wall] > 0 ? 311.0 : 0.0;
  return sample(texture, kScale_px_per_m * hit[(wall + 1) % 3] + 157.0 * wall + side,
                kScale_px_per_m * hit[(wall + 2) % 3] + 71.0 * wall + side);
}

cv::Mat render(const cv::Mat& texture, const Rigid3& world_from_camera) {
  cv::Mat image(kHeight_px, kWidth_px, CV_8UC1);
  const Mat3 rotation = world_from_camera.rotation.toRotationMatrix();
  for (int y = 0; y < kHeight_px; ++y) {
    for (int x = 0; x < kWidth_px; ++x) {
      const Vec3 ray_C((x - 0.5 * kWidth_px) / kFocal_px, (y - 0.5 * kHeight_px) / kFocal_px, 1.0);
      const float grey = wallGrey(texture, world_from_camera.translation, rotation * ray_C);
      image.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(grey);
    }
  }
  return image;
}

void writeCamera(const RoomRecording& recording, int camera, const cv::Mat& texture) {
  const std::filesystem::path folder = recording.sensor(fmt::format("cam{}", camera));
  std::filesystem::create_directories(folder / "data");
  const Eigen::Matrix4d m = bodyFromCamera(camera).matrix();
  std::ofstream yaml(folder / "sensor.yaml");
  yaml << "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int i = 0; i < 16; ++i) yaml << (i ? ", " : "") << m(i / 4, i % 4);
  yaml << fmt::format(
      "]\nrate_hz: 20\nresolution: [{}, {}]\ncamera_model: pinhole\nintrinsics: [{}, {}, {}, {}]\n"
      "distortion_model: radial-tangential\ndistortion_coefficients: [0.0, 0.0, 0.0, 0.0]\n",
      kWidth_px, kHeight_px, kFocal_px, kFocal_px, 0.5 * kWidth_px, 0.5 * kHeight_px);
  std::ofstream csv(folder / "data.csv");
  csv << "#timestamp [ns],filename\n";
  for (int i = 0; i < kRoomImages; ++i) {
    const double t = seconds(roomImageStamp_ns(i));
    const Rigid3 world_from_body(attitudeAt(t), positionAt(t));
    csv << roomImageStamp_ns(i) << "," << recording.image_names[static_cast<size_t>(i)] << "\n";
    cv::imwrite(recording.image(camera, static_cast<size_t>(i)).string(),
                render(texture, world_from_body * bodyFromCamera(camera)), {cv::IMWRITE_PNG_COMPRESSION, 1});
  }
}

void writeImu(const RoomRecording& recording) {
  std::filesystem::create_directories(recording.sensor("imu0"));
  std::ofstream(recording.sensor("imu0") / "sensor.yaml")
      << "sensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n"
         "  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: 200\n"
         "gyroscope_noise_density: 1.7e-4\ngyroscope_random_walk: 2.0e-5\n"
         "accelerometer_noise_density: 2.0e-3\naccelerometer_random_walk: 3.0e-3\n";
  std::ofstream csv(recording.csv("imu0"));
  csv << "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
  for (int64_t stamp_ns = kStart_ns - kImuLead_ns; stamp_ns <= roomImageStamp_ns(kRoomImages - 1);
       stamp_ns += kImuPeriod_ns) {
    const double t = seconds(stamp_ns);
    const Vec3 w = angularVelocityAt(t) + kGyroscopeBias_B;
    const Vec3 a =
        attitudeAt(t).conjugate() * (accelerationAt(t) - standardGravity_W()) + kAccelerometerBias_B;
    csv << fmt::format("{},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f},{:.9f}\n", stamp_ns, w.x(), w.y(), w.z(), a.x(),
                       a.y(), a.z());
  }
}

void writeTruth(const std::filesystem::path& file) {
  std::ofstream stream(file);
  for (int i = 0; i < kRoomImages; ++i) {
    const double t = seconds(roomImageStamp_ns(i));
    const Vec3 p = positionAt(t);
    const Quat q = attitudeAt(t);
    stream << fmt::format("{:.9f} {} {} {} {} {} {} {}\n", 1e-9 * static_cast<double>(roomImageStamp_ns(i)),
                          p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  }
}

}  // namespace

int64_t roomImageStamp_ns(int index) { return kStart_ns + index * kImagePeriod_ns; }

RoomRecording writeRoomRecording(const std::filesystem::path& folder) {
  RoomRecording recording{folder / "room", folder / "truth.tum", {}};
  for (int i = 0; i < kRoomImages; ++i) {
    recording.image_names.push_back(fmt::format("{}.png", roomImageStamp_ns(i)));
  }
  const cv::Mat texture = wallTexture();
  for (int camera = 0; camera < 2; ++camera) writeCamera(recording, camera, texture);
  writeImu(recording);
  writeTruth(recording.truth);
  return recording;
}

void writeBlankImage(const std::filesystem::path& file) {
  cv::imwrite(file.string(), cv::Mat(kHeight_px, kWidth_px, CV_8UC1, cv::Scalar(90)));
}

void editLines(const std::filesystem::path& file,
               const std::function<void(std::vector<std::string>&)>& edit) {
  std::ifstream input(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(input, line);) lines.push_back(line);
  edit(lines);
  std::ofstream output(file);
  for (const std::string& line : lines) output << line << "\n";
}

void replaceText(const std::filesystem::path& file, const std::string& from, const std::string& to) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  std::string content = text.str();
  const size_t at = content.find(from);
  if (at == std::string::npos) throw std::runtime_error(file.string() + ": holds no " + from);
  std::ofstream(file) << content.replace(at, from.size(), to);
}

}  // namespace lodeline::test

#include "lodeline/imu/test_real_recording.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

// Calls `row` with the stamp and the numbers after it, for every line that is not a comment.
void forEachRow(const std::filesystem::path& path,
                const std::function<void(Time, const std::vector<double>&)>& row) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) throw InputError("cannot open " + path.string());
  std::array<char, 1024> line;
  while (gzgets(file.get(), line.data(), line.size()) != nullptr) {
    if (line[0] == '#') continue;
    char* at = line.data();
    const Time time = Time::fromNanoseconds(std::strtoll(at, &at, 10));
    std::vector<double> numbers;
    while (*at == ',') numbers.push_back(std::strtod(at + 1, &at));
    row(time, numbers);
  }
}

Vec3 vectorAt(const std::vector<double>& numbers, size_t first) {
  return Vec3(numbers.at(first), numbers.at(first + 1), numbers.at(first + 2));
}

}  // namespace

RealRecording readRealRecording(const std::filesystem::path& imu_csv_gz,
                                const std::filesystem::path& truth_csv_gz) {
  RealRecording recording;
  forEachRow(imu_csv_gz, [&](Time time, const std::vector<double>& n) {
    recording.readings.push_back({time, vectorAt(n, 0), vectorAt(n, 3)});
  });
  forEachRow(truth_csv_gz, [&](Time time, const std::vector<double>& n) {
    const Quat rotation = Quat(n.at(3), n.at(4), n.at(5), n.at(6)).normalized();
    recording.truth.push_back(
        {time, Rigid3(rotation, vectorAt(n, 0)), vectorAt(n, 7), vectorAt(n, 10), vectorAt(n, 13)});
  });
  return recording;
}

std::vector<ImuSample> RealRecording::readingsBetween(Time from, Time to) const {
  const auto firstAfter = [&](Time time) {
    return std::upper_bound(readings.begin(), readings.end(), time,
                            [](Time t, const ImuSample& sample) { return t < sample.time; });
  };
  const auto at = [&](Time time) {
    const auto after = firstAfter(time);
    if (after == readings.begin() || after == readings.end()) throw InputError("no readings around a border");
    const ImuSample& before = *(after - 1);
    const double fraction = (time - before.time).seconds() / (after->time - before.time).seconds();
    return ImuSample{
        time, before.angular_velocity_B + fraction * (after->angular_velocity_B - before.angular_velocity_B),
        before.specific_force_B + fraction * (after->specific_force_B - before.specific_force_B)};
  };
  std::vector<ImuSample> span{at(from)};
  for (auto reading = firstAfter(from); reading->time < to; ++reading) span.push_back(*reading);
  span.push_back(at(to));
  return span;
}

}  // namespace lodeline

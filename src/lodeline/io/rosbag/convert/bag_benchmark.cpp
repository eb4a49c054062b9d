#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <opencv2/core.hpp>

#include "lodeline/io/rosbag/convert/ros1_writer.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/rosbag/ros1/ros1_bag.h"

// Measures the reading of all messages of a bag in the file cache, with the topics in parallel as in the
// synchronizer.

namespace lodeline {
namespace {

std::filesystem::path makeBag(const std::string& compression) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("lodeline_benchmark_" + compression + ".bag");
  Ros1Writer writer(file, compression);
  cv::Mat pixels(480, 752, CV_8UC1);
  cv::RNG random(1);
  random.fill(pixels, cv::RNG::NORMAL, 90.0, 8.0);
  constexpr int kImages = 200;
  for (uint32_t i = 0; i < kImages; ++i) {
    const Time time = Time::fromNanoseconds(1'000'000'000 + i * int64_t{50'000'000});
    for (const char* camera : {"cam0", "cam1"}) {
      writer.write(fmt::format("/{}", camera), messages::kImage.name, time,
                   messages::image(time, camera, pixels, i));
    }
    for (int64_t k = 0; k < 10; ++k) {
      const Time reading = time + Duration::fromNanoseconds(k * 5'000'000);
      writer.write("/imu", messages::kImu.name, reading, messages::imu({reading, {}, {}}, 0));
    }
  }
  writer.close();
  return file;
}

void readBag(benchmark::State& state, const std::string& compression) {
  const std::filesystem::path file = makeBag(compression);
  int64_t bytes = 0;
  for (auto _ : state) {
    Diagnostics diagnostics;
    Ros1Bag bag(file, &diagnostics);
    const size_t steps = bag.topics().front().entries.size();
    for (size_t step = 0; step < steps; ++step) {
      for (const BagTopic& topic : bag.topics()) {
        const size_t share = topic.entries.size() / steps;
        for (size_t i = step * share; i < (step + 1) * share; ++i)
          bytes += std::ssize(*bag.read(topic, topic.entries[i]));
      }
    }
  }
  state.SetBytesProcessed(bytes);
  std::filesystem::remove(file);
}

BENCHMARK_CAPTURE(readBag, uncompressed, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, lz4, "lz4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, bz2, "bz2")->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace lodeline

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/messages.h"

// Measures the reading of all messages of a bag in the file cache, with the topics in parallel as in the
// synchronizer.

namespace lodeline {
namespace {

std::filesystem::path makeBag(BagFormat format, const std::string& compression) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("lodeline_benchmark{}_{}.{}",
                                                           static_cast<int>(format), compression,
                                                           format == BagFormat::Ros1   ? "bag"
                                                           : format == BagFormat::Mcap ? "mcap"
                                                                                       : "db3");
  const std::unique_ptr<BagWriter> writer = makeBagWriter(file, format, compression);
  cv::Mat pixels(480, 752, CV_8UC1);
  cv::RNG random(1);
  random.fill(pixels, cv::RNG::NORMAL, 90.0, 8.0);
  constexpr int kImages = 200;
  for (uint32_t i = 0; i < kImages; ++i) {
    const Time time = Time::fromNanoseconds(1'000'000'000 + i * int64_t{50'000'000});
    for (const char* camera : {"cam0", "cam1"}) {
      writer->write(fmt::format("/{}", camera), messages::kImage.name, time,
                    messages::image(time, camera, pixels, i));
    }
    for (int64_t k = 0; k < 10; ++k) {
      const Time reading = time + Duration::fromNanoseconds(k * 5'000'000);
      writer->write("/imu", messages::kImu.name, reading, messages::imu({reading, {}, {}}, 0));
    }
  }
  writer->close();
  return file;
}

void readBag(benchmark::State& state, BagFormat format, const std::string& compression) {
  const std::filesystem::path file = makeBag(format, compression);
  int64_t bytes = 0;
  for (auto _ : state) {
    Diagnostics diagnostics;
    const std::unique_ptr<BagFile> opened = openBagFile(file, &diagnostics);
    BagFile& bag = *opened;
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

BENCHMARK_CAPTURE(readBag, uncompressed, BagFormat::Ros1, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, lz4, BagFormat::Ros1, "lz4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, bz2, BagFormat::Ros1, "bz2")->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK_CAPTURE(readBag, mcap, BagFormat::Mcap, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, mcap_lz4, BagFormat::Mcap, "lz4")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, mcap_zstd, BagFormat::Mcap, "zstd")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(readBag, db3, BagFormat::Database, "none")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lodeline

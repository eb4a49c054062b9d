#include "lodeline/output/files/timing_writer.h"

#include <fmt/ostream.h>

#include "lodeline/util/files/output_file.h"

namespace lodeline {

TimingWriter::TimingWriter(const std::filesystem::path& folder)
    : stream_(openOutput(folder / "timings.csv")) {
  stream_ << "#timestamp [ns],wall [s],front_end [s],estimator [s],pictures [s]\n";
}

void TimingWriter::write(Time time, const StageTimes& times, double pictures_s) {
  const Clock::time_point now = Clock::now();
  fmt::print(stream_, "{},{:.6f},{:.6f},{:.6f},{:.6f}\n", time.nanoseconds(),
             std::chrono::duration<double>(now - last_).count(), times.front_end_s - before_.front_end_s,
             times.estimator_s - before_.estimator_s, pictures_s - pictures_before_s_);
  last_ = now;
  before_ = times;
  pictures_before_s_ = pictures_s;
}

}  // namespace lodeline

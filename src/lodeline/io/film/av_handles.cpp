#include "lodeline/io/film/av_handles.h"

#include <fmt/core.h>

#include <mutex>

#include "lodeline/diagnostics.h"

namespace lodeline::av {
namespace {

/// Findings report the faults; the libraries would print them too.
void silence() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_level(AV_LOG_QUIET); });
}

}  // namespace

std::string errorText(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof text);
  return text;
}

Input openInput(const std::filesystem::path& file) {
  silence();
  if (std::error_code error; !std::filesystem::exists(file, error)) {
    throw InputError(file.string() + ": no such file");
  }
  AVFormatContext* opened = nullptr;
  // The prefix keeps names with a colon from being taken for addresses.
  const int result = avformat_open_input(&opened, ("file:" + file.string()).c_str(), nullptr, nullptr);
  if (result < 0) {
    const std::string reason =
        result == AVERROR_INVALIDDATA
            ? std::string(
                  "no film that can be read: its index is missing or damaged. A camera writes the index when "
                  "the recording ends; let the camera repair the file, or copy it again")
            : errorText(result);
    throw InputError(fmt::format("{}: {}", file.string(), reason));
  }
  Input input(opened);
  if (const int found = avformat_find_stream_info(input.get(), nullptr); found < 0) {
    throw InputError(fmt::format("{}: its tracks cannot be read: {}", file.string(), errorText(found)));
  }
  return input;
}

void readOnly(AVFormatContext* input, int track) {
  for (unsigned i = 0; i < input->nb_streams; ++i) {
    input->streams[i]->discard = static_cast<int>(i) == track ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
  }
}

}  // namespace lodeline::av

#include "lodeline/node/node_main.h"

#include <fmt/core.h>
#include <glog/logging.h>

#include <chrono>

#include "lodeline/diagnostics.h"
#include "lodeline/util/printable_text.h"

namespace lodeline {
namespace {

constexpr std::chrono::milliseconds kPause{20};

int fail(const char* kind, const std::exception& error, int code) {
  fmt::print(stderr, "{}: {}\n", kind, printableText(error.what()));
  return code;
}

}  // namespace

int runNodeMain(const char* program, const std::function<void()>& body) {
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::GLOG_ERROR;  // as in the program `lodeline`
  google::InitGoogleLogging(program);
  try {
    body();
    return 0;
  } catch (const InputError& error) {
    return fail("bad input", error, 1);
  } catch (const UsageError& error) {
    return fail("bad usage", error, 2);
  } catch (const std::exception& error) {
    return fail("estimation failed", error, 3);
  }
}

EndWatch::EndWatch(RosSession* session, std::function<bool()> is_over)
    : thread_([this, session, is_over = std::move(is_over)] {
        while (!over_ && !stop_.made() && !is_over()) std::this_thread::sleep_for(kPause);
        session->close();
      }) {}

EndWatch::~EndWatch() {
  over_ = true;
  thread_.join();
}

}  // namespace lodeline

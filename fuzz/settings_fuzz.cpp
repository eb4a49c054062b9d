#include "fuzzed_file.h"
#include "lodeline/util/settings/settings.h"

// Configuration files.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".yaml");
  return fuzz::expectDocumentedErrors([&] {
    bool flag = false;
    int count = 0;
    double number = 0.0;
    std::string text;
    std::vector<double> list;
    Settings settings;
    settings.bind("a.flag", &flag, "");
    settings.bind("a.count", &count, "", 0);
    settings.bind("b.number", &number, "");
    settings.bind("b.text", &text, "");
    settings.bind("list", &list, "");
    settings.load(file.path().string());
  });
}

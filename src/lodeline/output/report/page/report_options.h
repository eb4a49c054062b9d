#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/run_evaluation.h"

namespace lodeline {

/// What a page shows beside the files of its runs.
struct ReportOptions {
  std::optional<ReportReference> reference = std::nullopt;
  /// The stations of a run's survey (`Station[]` in web/src/data.ts), with times since `origin_ns`; null
  /// where it has none. Not set: the page shows no survey.
  std::function<nlohmann::ordered_json(const std::filesystem::path& run, int64_t origin_ns)> stations =
      nullptr;
  nlohmann::ordered_json background = nullptr;                 ///< as readBackground() gives it
  std::function<void(double share)> progress = [](double) {};  ///< takes the share of the work that is done
};

}  // namespace lodeline

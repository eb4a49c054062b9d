#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace lodeline {

/// The stations of a run's survey with passage sizes and splays for the report page (`Station[]` in
/// web/src/data.ts). `lodeline export` makes the same by default. They are in the world of the run. null
/// where the run has no survey, as one whose way is too short.
nlohmann::ordered_json runStationsJson(const std::filesystem::path& run, int64_t origin_ns);

}  // namespace lodeline

#pragma once

#include <filesystem>

namespace lodeline {

/// Throws UsageError where results in `output` would mix with the recording `data`: the folder is the
/// recording, lies inside of it beside its sensors, or is one itself.
void refuseRecordingAsOutput(const std::filesystem::path& data, const std::filesystem::path& output);

/// Throws UsageError where `output` holds another run's results, which a new run would replace.
void refuseToReplaceRun(const std::filesystem::path& output);

}  // namespace lodeline

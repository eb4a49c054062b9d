#pragma once

#include <filesystem>

namespace lodeline {

/// Throws UsageError where results in `output` would mix with the recording `data`: the folder is the
/// recording, is inside it beside its sensors, or is a recording itself.
void refuseRecordingAsOutput(const std::filesystem::path& data, const std::filesystem::path& output);

/// Throws UsageError where `output` contains the results of another run, which a new run would replace.
void refuseToReplaceRun(const std::filesystem::path& output);

}  // namespace lodeline

#pragma once

#include <string>
#include <vector>

#include "lodeline/io/dives/depth_profile.h"

namespace lodeline {

/// The profiles of one dive of a log: of all its dives where it has one; else
/// of that which `choice` names by its number or by the start of its date
/// ("2026-11-21", "2026-11-21 10:34"). The number is that of the log, or the
/// position in it, from 1, where the log numbers no dive. Throws InputError,
/// with a list of the dives, where `choice` is empty and there are several, and
/// UsageError where it names no dive or several.
std::vector<DepthProfile> chooseDive(const std::vector<DepthProfile>& profiles, const std::string& choice);

}  // namespace lodeline

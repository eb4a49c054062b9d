#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lodeline/output/survey/profile/profile_rows.h"

namespace lodeline {

/// Called for each row that is passed over, with the reason.
using PassOverRow = std::function<void(const ProfileRow& row, const std::string& reason)>;

/// The dives of a log: stretches in which times increase by no more than ten minutes, or ten times the usual
/// step, a reading. Single rows whose times do not fit into their neighbourhood (a clock that was set, a
/// digit that was lost) are passed over and do not end a stretch. A clock that counts to 24 h runs on past
/// midnight. Stretches of fewer than five rows are passed over.
std::vector<std::vector<ProfileRow>> splitDives(const std::vector<ProfileRow>& rows,
                                                const PassOverRow& pass_over);

/// Makes depths positive downwards, and passes over those that no diver can have reached from one reading to
/// the next: marks of a missing value (65535, 999.9, -1, 0 between deep readings). The limits are relative to
/// the depths of the dive, since their unit may not be known.
void screenDepths(std::vector<ProfileRow>* dive, const PassOverRow& pass_over);

}  // namespace lodeline

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lodeline/io/dives/profile_rows.h"

namespace lodeline {

/// Called for each row that is skipped, with the reason.
using PassOverRow = std::function<void(const ProfileRow& row, const std::string& reason)>;

/// Splits a log into dives: sequences in which the time increases by at most
/// ten minutes, or ten times the usual step, per reading. Single rows with
/// inconsistent times (a clock that was set, a lost digit) are skipped and do
/// not end a dive. A clock that counts to 24 h continues past midnight.
/// Sequences of fewer than five rows are skipped. With `has_stated_dives`, a
/// dive may have any steps and two rows.
std::vector<std::vector<ProfileRow>> splitDives(const std::vector<ProfileRow>& rows, bool has_stated_dives,
                                                const PassOverRow& pass_over);

/// Makes depths positive downwards, and skips those that no diver can have
/// reached between two readings: marks of a missing value (65535, 999.9, -1, 0
/// between deep readings). The limits are relative to the depths of the dive,
/// because their unit may be unknown.
void screenDepths(std::vector<ProfileRow>* dive, const PassOverRow& pass_over);

}  // namespace lodeline

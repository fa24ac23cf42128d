#pragma once

#include "apps/commands/profile/profile.h"

#include <vector>

namespace springtower {

/// What has a name and a size, with one method and tolerance: its results on each number of threads, of which the first has what
/// is common to all.
struct NamedRow {
  std::vector<const ProfileResult*> results;
  [[nodiscard]] const ProfileResult& first() const { return *results.front(); }
  /// Null where it was not timed on so many.
  [[nodiscard]] const ProfileResult* on(int threads) const;
};

/// The rows of the scenes for which `isOne` holds, in the order of the profile.
std::vector<NamedRow> rowsOf(const Profile& profile, bool (*isOne)(ProfileScene));

}  // namespace springtower

#include "apps/commands/profile/named_row.h"

#include <algorithm>

namespace springtower {

const ProfileResult* NamedRow::on(int threads) const {
  const auto found =
      std::find_if(results.begin(), results.end(), [&](const ProfileResult* result) { return result->what.threads == threads; });
  return found == results.end() ? nullptr : *found;
}

std::vector<NamedRow> rowsOf(const Profile& profile, bool (*isOne)(ProfileScene)) {
  std::vector<NamedRow> rows;
  for (const ProfileResult& result : profile.results) {
    if (!isOne(result.what.scene)) continue;
    const auto same = [&](const NamedRow& row) {
      ProfileCase what = row.first().what;
      what.threads = result.what.threads;
      return what == result.what;
    };
    const auto found = std::find_if(rows.begin(), rows.end(), same);
    if (found == rows.end()) {
      rows.push_back({{&result}});
    } else {
      found->results.push_back(&result);
    }
  }
  return rows;
}

}  // namespace springtower

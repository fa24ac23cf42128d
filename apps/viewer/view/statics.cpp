#include "apps/viewer/view/statics.h"

#include <chrono>
#include <utility>

namespace springtower {
namespace {

void take(StaticsAnswer& answer) {
  answer.margin = answer.coming.get();
  answer.known = true;
}

}  // namespace

void followStatics(StaticsAnswer& answer, const Session& session, BlockId without, std::uint64_t every, bool waits) {
  const auto ready = [&] { return waits || answer.coming.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
  if (answer.coming.valid()) {
    if (!ready()) return;
    take(answer);
  }
  const bool same = answer.without == without;
  if (!same) answer.known = false;
  const bool fresh = same && answer.known && answer.frame <= session.frame && session.frame < answer.frame + every;
  if (fresh) return;
  answer.without = without;
  answer.frame = session.frame;
  auto question = withoutBlock(session.simulation, session.contacts, without);
  if (!question) {
    answer.known = false;
    return;
  }
  answer.coming = std::async(std::launch::async, [asked = std::move(*question)] { return marginOf(asked); });
  if (waits) take(answer);
}

}  // namespace springtower

#include "apps/viewer/view/statics.h"

#include <chrono>
#include <utility>

namespace springtower {
namespace {

constexpr int kRest = 3;  // times as long as an answer took

void take(StaticsAnswer& answer) {
  answer.margin = answer.coming.get();
  answer.known = true;
  const auto now = std::chrono::steady_clock::now();
  answer.next = now + kRest * (now - answer.started);
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
  const bool recent = answer.frame <= session.frame && (answer.asleep || session.frame < answer.frame + every);
  const bool asleep = allAsleep(session.simulation);
  if (same && answer.known && recent && (!answer.asleep || asleep)) return;
  const auto now = std::chrono::steady_clock::now();
  if (!waits && same && now < answer.next) return;
  answer.without = without;
  answer.frame = session.frame;
  answer.asleep = asleep;
  answer.started = now;
  auto question = withoutBlock(session.simulation, session.contacts, without);
  if (!question) {
    answer.known = false;
    return;
  }
  answer.coming = std::async(std::launch::async, [asked = std::move(*question)] { return marginOf(asked); });
  if (waits) take(answer);
}

}  // namespace springtower

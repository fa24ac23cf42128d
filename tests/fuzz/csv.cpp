// Readers of comma-separated values: sets of collision queries, and what other engines' runs have left. The first byte says
// which.
#include "apps/commands/chart/recorded_peers.h"
#include "core/error.h"
#include "narrowphase/exact/query_set.h"
#include "tests/fuzz/fuzz.h"

#include <cmath>

namespace springtower {
namespace {

constexpr std::size_t kMostAnswers = 4;  // exact ones take up to milliseconds

void readQueries(const InputFile& file) {
  const std::vector<CollisionQuery> queries = readCollisionQueries(file.path());
  requireThat(!queries.empty(), "a set has a query");
  for (std::size_t i = 0; i < std::min(queries.size(), kMostAnswers); ++i) {
    for (const QueryKind kind : {QueryKind::pointTriangle, QueryKind::edgeEdge}) {
      const TimeOfImpact found = answer(queries[i], kind);
      requireThat(found.time >= 0.0 && found.time <= 1.0, "a time of impact is within the step");
      judge(queries[i], found);
    }
  }
}

void readCsv(bool peers, std::string_view text) {
  const InputFile file(text);
  try {
    if (!peers) return readQueries(file);
    for (const PeerResult& peer : readPeers(file.path(), {}))
      requireThat(!std::isinf(peer.frame_ms), "times are finite or unknown");
  } catch (const InputError& error) {
    requireMessage(error.what(), file.path());
  }
}

}  // namespace
}  // namespace springtower

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 0) springtower::readCsv(data[0] % 2 != 0, springtower::textOf(data + 1, size - 1));
  return 0;
}

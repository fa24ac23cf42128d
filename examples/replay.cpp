// A tower that is pushed over, played twice from one snapshot: once by the same world, once by another on one thread. All bits
// are the same.
#include <cinttypes>
#include <cstdio>
#include <springtower/inputs.h>
#include <springtower/scene.h>
#include <springtower/world.h>

namespace st = springtower::api;

namespace {

// A push at the top for a quarter of a second, and what becomes of it. Returns 0 where the simulation fails.
std::uint64_t play(st::World& world) {
  const int top = world.blockCount() - 2;
  st::applyForce(world, {top, -1, {1.0, 0.0, 0.0}, world.time_s(), world.time_s() + 0.25});
  if (world.step(40)) return 0;
  return world.stateHash();
}

}  // namespace

int main() {
  const st::Scene scene = st::towerScene(4);
  st::World world(scene);
  world.prepare();
  if (world.step(30)) return 3;
  const st::Snapshot before = world.snapshot();

  const std::uint64_t first = play(world);
  world.restore(before);
  const std::uint64_t again = play(world);

  const st::ThreadLimit oneThread(1);
  st::World other(scene);
  other.prepare();
  other.restore(before);
  const std::uint64_t elsewhere = play(other);

  std::printf("from %.1f s to %.1f s: %016" PRIx64 ", again %016" PRIx64 ", in another world %016" PRIx64 "\n", before.time_s(),
              world.time_s(), first, again, elsewhere);
  return first != 0 && first == again && first == elsewhere ? 0 : 1;
}

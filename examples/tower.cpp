// A tower of 18 rows stands for two seconds. How far is it off the height of rigid blocks, and how deep do blocks overlap?
#include <cstdio>
#include <springtower/query.h>
#include <springtower/scene.h>
#include <springtower/statics.h>
#include <springtower/world.h>

namespace st = springtower::api;

int main() {
  const int rows = 18;
  const st::Scene scene = st::towerScene(rows);
  if (st::verdict(scene) != st::Verdict::stands) return 1;

  st::World world(scene);
  world.prepare();
  if (const auto failed = world.step(120)) {
    std::fprintf(stderr, "%s\n", failed->cause.c_str());
    return 3;
  }
  const int top = world.blockCount() - 2;  // the middle block of the top row
  const double error_m = world.pose(top).centre.z - scene.blocks[static_cast<std::size_t>(top)].centre.z;
  const double overlap_m = st::deepestPenetration(world).depth_m;
  std::printf("after %.1f s: height error %.4f mm, deepest overlap %.4f mm, tolerance %.4f mm\n", world.time_s(), 1e3 * error_m,
              1e3 * overlap_m, 1e3 * world.tolerance_m());
  // Each row may be compressed, and sink into the one below, by the tolerance.
  const bool stands = error_m <= 0.0 && error_m >= -2 * rows * world.tolerance_m();
  return stands && overlap_m <= world.tolerance_m() ? 0 : 1;
}

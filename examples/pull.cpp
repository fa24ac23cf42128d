// The hand draws the middle block of a tower's middle row out along its length. What force does that take?
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <springtower/inputs.h>
#include <springtower/query.h>
#include <springtower/scene.h>
#include <springtower/world.h>

namespace st = springtower::api;

int main() {
  const int rows = 6;
  const int block = 3 * (rows / 2) + 1;  // an odd row: it lies along y
  st::World world(st::towerScene(rows));
  world.prepare();
  const auto fails = [&](int frames) {
    const auto failed = world.step(frames);
    if (failed) std::fprintf(stderr, "%s\n", failed->cause.c_str());
    return failed.has_value();
  };
  if (fails(20)) return 3;

  double normal_n = 0.0;
  for (const st::Contact& contact : st::contactsOn(world, block)) normal_n += contact.normalForce_n;
  const double friction_n = 0.4 * normal_n;
  std::printf("contacts press the block with %.3f N in all: friction holds it with up to %.3f N\n", normal_n, friction_n);

  const st::Vec3 start = world.pose(block).centre;
  const double speed_m_s = 0.08;
  double most_n = 0.0;
  st::pull(world, block, {0.0, 1.0, 0.0}, speed_m_s);
  for (int frame = 1; frame <= 90; ++frame) {
    if (fails(1)) return 3;
    const double force_n = st::handState(world).force_n.y;
    most_n = std::max(most_n, force_n);
    if (frame % 15 != 0) continue;
    std::printf("%.2f s: drawn out by %5.1f mm, force %.3f N\n", world.time_s(), 1e3 * (world.pose(block).centre.y - start.y),
                force_n);
  }
  st::release(world);

  double lowest_m = 1.0;
  for (int other = 0; other < 3; ++other) lowest_m = std::min(lowest_m, world.pose(3 * (rows - 1) + other).centre.z);
  std::printf("the largest force was %.3f N; the top row lies at %.1f mm\n", most_n, 1e3 * lowest_m);
  // 90 frames at 80 mm/s draw it out by its length and more; what is above still stands on its neighbours. Friction that holds
  // and friction that slides are equal here, so that the force hardly exceeds it while the block speeds up.
  const bool drawn = world.pose(block).centre.y - start.y > 0.081;
  const bool stands = std::abs(lowest_m - (rows - 0.5) * 0.0182) < 1e-3;
  return drawn && stands && most_n < 1.5 * friction_n ? 0 : 1;
}

// A program outside the repository: it finds the installed library, lets a small tower stand, draws a block out, goes back, and
// does the same again.
#include <cstdio>
#include <springtower/springtower.h>

namespace st = springtower::api;

namespace {

constexpr int kRows = 4;
constexpr int kDrawn = 3 + 1;  // the middle block of the second row, which lies along y

bool require(bool holds, const char* what) {
  std::printf("%s: %s\n", what, holds ? "yes" : "no");
  return holds;
}

// Draws the block for half a second. Returns the hash of the state then, 0 where the simulation fails.
std::uint64_t draw(st::World& world) {
  st::pull(world, kDrawn, {0.0, 1.0, 0.0}, 0.08);
  if (const auto failed = world.step(30)) {
    std::printf("%s\n", failed->cause.c_str());
    return 0;
  }
  return world.stateHash();
}

bool stands(st::World& world, const st::Scene& scene) {
  if (world.step(30)) return false;
  const int top = world.blockCount() - 1;
  const double fall_m = scene.blocks.back().centre.z - world.pose(top).centre.z;
  std::printf("springtower %s: the top block sank by %.4f mm\n", st::buildInfo().version.data(), 1e3 * fall_m);
  // Each row may be compressed, and sink into what carries it, by the tolerance.
  return fall_m > 0.0 && fall_m <= 2 * kRows * world.tolerance_m();
}

bool refusesABlockThatIsNotThere(const st::World& world) {
  try {
    static_cast<void>(world.pose(world.blockCount()));
  } catch (const st::InputError& error) {
    std::printf("%s\n", error.what());
    return true;
  }
  return false;
}

}  // namespace

int main() {
  const st::Scene scene = st::towerScene(kRows);
  st::World world(scene);
  world.prepare();
  bool good = require(stands(world, scene), "it stands");

  const st::Snapshot before = world.snapshot();
  const double start_m = world.pose(kDrawn).centre.y;
  const std::uint64_t first = draw(world);
  const double drawn_m = world.pose(kDrawn).centre.y - start_m;
  world.restore(before);
  good = require(drawn_m > 0.02 && world.pose(kDrawn).centre.y == start_m, "the block was drawn, and lies where it did") && good;
  good = require(first != 0 && draw(world) == first, "the same again, bit for bit") && good;

  good = require(st::verdict(scene) == st::Verdict::stands, "statics: it stands") && good;
  good = require(st::verdictWithout(scene, kDrawn) == st::Verdict::stands, "statics: it stands without the block") && good;
  const auto margin = st::stabilityMargin(scene);
  good = require(margin && margin->tilt_deg > 5.0, "statics: it may lean by 5 degrees") && good;
  good = require(refusesABlockThatIsNotThere(world), "a block that is not there is refused") && good;
  return good ? 0 : 1;
}

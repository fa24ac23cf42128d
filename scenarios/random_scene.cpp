#include "scenarios/random_scene.h"

#include "core/error.h"
#include "scenarios/random_blocks.h"
#include "scenarios/random_fixtures.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace springtower {
namespace {

constexpr double kMoveMassSigma_kg = 0.005;  // of tower blocks that do not all have the same mass; cut off below 0.0059
constexpr int kMaxTowerRows = 12;

Method drawMethod(RandomDraw& draw) {
  constexpr std::array kMethods = {Method::implicit,          Method::automatic, Method::implicitEuler, Method::implicitEigen,
                                   Method::semiImplicitEuler, Method::rigidPgs,  Method::xpbd,          Method::midpoint,
                                   Method::rungeKutta4,       Method::report,    Method::rigidLcp};
  return kMethods[draw.pick({0.3, 0.2, 0.05, 0.04, 0.13, 0.11, 0.11, 0.015, 0.015, 0.015, 0.015})];
}

// All that is not blocks, moves or forces. The blocks are there.
void drawSurroundings(RandomDraw& draw, RandomScene& random) {
  Scene& scene = random.scene;
  const bool space = random.kind == RandomKind::space;
  const bool hand = random.kind == RandomKind::hand;
  scene.floor = !space;
  const Friction friction = drawFriction(draw, kMaxRandomFriction);
  scene.staticFriction = friction.staticFriction;
  scene.kineticFriction = friction.kineticFriction;
  const double gravity = draw.between(hand ? 2.0 : 0.0, kMaxRandomGravity_m_s2);
  if (draw.chance(0.5)) scene.gravity.magnitude = gravity;
  if (!hand && draw.chance(0.03)) scene.gravity.magnitude = 0.0;
  const double tilt = draw.logBetween(0.01, hand ? 3.0 : 20.0);
  const double direction = draw.between(-180.0, 180.0);
  if (draw.chance(0.2) && !space) {
    scene.gravity.tilt_deg = tilt;
    scene.gravity.direction_deg = direction;
  }
  if (space) scene.gravity.magnitude = 0.0;
  Settings& settings = scene.settings;
  const double tolerance = draw.logBetween(kMinRandomTolerance_m, kMaxRandomTolerance_m);
  if (draw.chance(0.7)) settings.tolerance_m = std::min(tolerance, kMaxRandomToleranceShare * blockHeightOf(scene));
  settings.sleep = draw.chance(0.75) ? Sleep::on : Sleep::off;
  settings.inertia = draw.chance(0.9) ? Inertia::cuboid : Inertia::lumped;
  scene.seconds = std::round(100.0 * draw.between(1.0, kMaxRandomSeconds)) / 100.0;
}

// Rows from the bottom: most of them full, some with one or two blocks, some with a loose one.
std::string drawCode(RandomDraw& draw, int rows) {
  constexpr std::array<std::string_view, 8> kRows = {"111", "11L", "1L1", "L11", "101", "010", "1L0", "011"};
  std::string code;
  for (int row = 0; row < rows; ++row) {
    code += fmt::format("{}({})", row == 0 ? "" : "-", kRows[draw.pick({0.5, 0.08, 0.08, 0.08, 0.1, 0.1, 0.03, 0.03})]);
  }
  return code;
}

// A block of the tower below its top row.
const BlockSpec& drawTowerBlock(RandomDraw& draw, const Scene& scene, int rows) {
  for (;;) {
    const auto last = static_cast<int>(scene.blocks.size()) - 1;
    const BlockSpec& block = scene.blocks[static_cast<std::size_t>(draw.whole(0, last))];
    if (block.row < rows - 1 || rows == 1) return block;
  }
}

Vec3 drawLevelDirection(RandomDraw& draw) {
  const Vec3 axis = draw.chance(0.5) ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY());
  return draw.chance(0.5) ? axis : Vec3(-axis);
}

void addMoves(RandomDraw& draw, Scene& scene, int rows) {
  const BlockSpec& block = drawTowerBlock(draw, scene, rows);
  Move take;
  take.row = block.row;
  take.position = block.position;
  take.towards = drawLevelDirection(draw);
  take.speed_m_s = draw.logBetween(0.01, 1.0);
  take.limit_n = draw.chance(0.5) ? take.limit_n : draw.logBetween(0.5, 20.0);
  Move put = take;
  put.kind = draw.chance(0.5) ? MoveKind::put : MoveKind::putAside;
  put.towards = Vec3::UnitX();
  put.speed_m_s = Move{}.speed_m_s;
  put.row = put.kind == MoveKind::put ? rows : 0;
  put.position = put.kind == MoveKind::put ? draw.whole(1, 3) : 1;
  if (put.kind == MoveKind::put && draw.chance(0.4)) put.drop_m = draw.logBetween(1e-3, 0.05);
  scene.moves = {take, put};
  scene.seconds = kMaxRandomMoveSeconds;
}

// A force for some time instead of moves, up to some weights of the block.
void addForce(RandomDraw& draw, Scene& scene, int rows) {
  const BlockSpec& block = drawTowerBlock(draw, scene, rows);
  UserForce force;
  force.block = static_cast<int>(&block - scene.blocks.data());
  force.corner = draw.chance(0.7) ? -1 : draw.whole(0, 7);
  const double weights = draw.logBetween(0.1, 30.0);  // two statements, as the order within one is the compiler's
  const Vec3 direction = drawLevelDirection(draw);
  force.force = direction * (weights * block.mass * kStandardGravity_m_s2);
  force.start_s = draw.between(0.0, 0.5);
  force.end_s = force.start_s + draw.between(0.1, 1.0);
  scene.forces = {force};
}

void drawHand(RandomDraw& draw, RandomScene& random, const BlockManner& manner, Method method) {
  const int rows = method == Method::rigidLcp ? 2 : static_cast<int>(draw.logBetween(2.0, kMaxTowerRows));
  random.towerCode = drawCode(draw, rows);
  random.tower.seed = static_cast<std::uint64_t>(draw.whole(1, 1000000));
  if (draw.chance(0.5)) random.tower.heightsSigma_m = draw.logBetween(1e-6, 2e-4);
  if (manner.massRatio > 1.0) random.tower.massSigma_kg = draw.between(0.0, kMoveMassSigma_kg);
  rebuildTower(random, 0);
  Scene& scene = random.scene;
  drawSurroundings(draw, random);
  if (draw.chance(0.7)) {
    addMoves(draw, scene, rows);
  } else {
    addForce(draw, scene, rows);
  }
  // Weights on the floor beside the tower, where blocks may fall on them.
  const int weights = manner.massRatio > 10.0 ? draw.whole(1, 2) : 0;
  for (int w = 0; w < weights; ++w) {
    BlockSpec weight;
    weight.centre = Vec3(w == 0 ? 0.12 : -0.12, 0.0, 0.5 * weight.dimensions.z());
    weight.mass = draw.logBetween(kBlockMass_kg, 0.05 * manner.massRatio * kBlockMass_kg);
    scene.blocks.push_back(weight);
  }
}

RandomScene drawScene(RandomDraw& draw) {
  RandomScene random;
  random.kind = kRandomKinds[draw.pick({0.30, 0.12, 0.24, 0.14, 0.12, 0.08})];
  const Method method = drawMethod(draw);
  const BlockManner manner = drawBlockManner(draw);
  const auto most = method == Method::rigidLcp ? kMaxRandomLcpBlocks : kMaxRandomBlocks;
  const auto count = std::min(most, static_cast<std::size_t>(draw.logBetween(kMinRandomBlocks, static_cast<double>(most) + 1.0)));
  switch (random.kind) {
    case RandomKind::stack:
      random.scene.blocks = drawStack(draw, manner, count);
      break;
    case RandomKind::plank:
      random.scene.blocks = drawPlanks(draw, manner, count);
      break;
    case RandomKind::air:
      random.scene.blocks = drawFlying(draw, manner, count, true);
      break;
    case RandomKind::space:
      random.scene.blocks = drawFlying(draw, manner, count, false);
      break;
    case RandomKind::shot:
      random.scene.blocks = drawShot(draw, manner, count);
      break;
    case RandomKind::hand:
      drawHand(draw, random, manner, method);
      break;
  }
  if (random.kind != RandomKind::hand) drawSurroundings(draw, random);
  random.scene.settings.method = method;
  return random;
}

}  // namespace

std::string_view nameOf(RandomKind kind) {
  constexpr std::array<std::string_view, kRandomKinds.size()> kNames = {"stack", "plank", "air", "space", "shot", "hand"};
  return kNames[static_cast<std::size_t>(kind)];
}

RandomScene randomScene(std::uint64_t seed) {
  RandomDraw draw(seed);
  RandomDraw surroundings(seed, RandomStreamOf::surroundings);
  for (;;) {
    RandomScene random = drawScene(draw);
    drawSurfaces(surroundings, kMaxRandomFriction, random.scene);
    if (random.kind != RandomKind::hand) drawFixtures(surroundings, random.scene);
    random.scene.name = fmt::format("random-{}-{}", seed, nameOf(random.kind));
    try {
      checkScene(random.scene, random.scene.name);
      return random;
    } catch (const InputError&) {
      // The next draw of the same stream: a tower whose row has nothing below it, say.
    }
  }
}

void rebuildTower(RandomScene& random, std::size_t towerBlocks) {
  std::vector<BlockSpec> blocks = bitCodeScene(random.towerCode, random.tower).blocks;
  const auto& old = random.scene.blocks;
  blocks.insert(blocks.end(), old.begin() + static_cast<std::ptrdiff_t>(towerBlocks), old.end());
  random.scene.blocks = std::move(blocks);
}

double massRatioOf(const Scene& scene) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    if (block.fixed) continue;
    least = std::min(least, block.mass);
    most = std::max(most, block.mass);
  }
  return most / least;
}

}  // namespace springtower

#include "solver/sleep/support_check.h"

#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/sleep/support_solver.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

double heightOf(const Simulation& simulation, std::int32_t block, const Vec3& up) {
  return centre(simulation.state.position, static_cast<std::size_t>(block)).dot(up);
}

// Lists the pairs of each sleeper.
void listPairsOfSleepers(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& path = engine.scratch.support;
  const auto forEach = [&](const auto& visit) {
    for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
      if (!engine.pairs.touches(p)) continue;
      const BlockPair& pair = engine.pairs.key[p];
      if (sleeps(simulation, pair.a)) visit(static_cast<std::size_t>(pair.a), p);
      if (pair.b >= 0 && sleeps(simulation, pair.b)) visit(static_cast<std::size_t>(pair.b), p);
    }
  };
  path.start.assign(simulation.asleep.size() + 1, 0);
  forEach([&](std::size_t b, std::size_t) { ++path.start[b + 1]; });
  for (std::size_t b = 0; b < simulation.asleep.size(); ++b) path.start[b + 1] += path.start[b];
  path.pairs.resize(static_cast<std::size_t>(path.start.back()));
  engine.scratch.cursor.assign(path.start.begin(), path.start.end());
  forEach([&](std::size_t b, std::size_t p) {
    path.pairs[static_cast<std::size_t>(engine.scratch.cursor[b]++)] = static_cast<std::int32_t>(p);
  });
}

template <typename Visit>
void forEachPair(const Engine& engine, std::int32_t block, const Visit& visit) {
  const SupportCheckScratch& path = engine.scratch.support;
  const auto b = static_cast<std::size_t>(block);
  for (auto k = static_cast<std::size_t>(path.start[b]); k < static_cast<std::size_t>(path.start[b + 1]); ++k) {
    visit(path.pairs[k], engine.pairs.key[static_cast<std::size_t>(path.pairs[k])]);
  }
}

// Lists the sleepers that touch those which are pushed, directly or through others, from the top down. Their changes become
// torques about the origin, with the margin.
void listSleepers(Simulation& simulation, const Vec3& up) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& path = engine.scratch.support;
  path.blocks.assign(engine.scratch.pushed.begin(), engine.scratch.pushed.end());
  for (const std::int32_t block : path.blocks) {
    LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(block)];
    change.torque = tuning::kSupportSafetyFactor *
                    (change.torque + centre(simulation.state.position, static_cast<std::size_t>(block)).cross(change.force));
    change.force *= tuning::kSupportSafetyFactor;
  }
  for (std::size_t i = 0; i < path.blocks.size(); ++i) {
    const std::int32_t block = path.blocks[i];
    forEachPair(engine, block, [&](std::int32_t, const BlockPair& pair) {
      const std::int32_t other = pair.a == block ? pair.b : pair.a;
      if (other < 0 || !sleeps(simulation, other) || engine.scratch.joined[static_cast<std::size_t>(other)] != 0) return;
      engine.scratch.joined[static_cast<std::size_t>(other)] = 1;
      engine.scratch.loadChange[static_cast<std::size_t>(other)] = {};
      path.blocks.push_back(other);
    });
  }
  std::sort(path.blocks.begin(), path.blocks.end(), [&](std::int32_t a, std::int32_t b) {
    const double heightA = heightOf(simulation, a, up);
    const double heightB = heightOf(simulation, b, up);
    return heightA != heightB ? heightA > heightB : a < b;
  });
}

// Whether one sleeper of a pair bears the other: what only leans on another, or lies beside it, does not go with it.
bool isVertical(const SleepLoad& load, const Vec3& up) {
  return std::abs(load.force.dot(up)) > tuning::kSupportCosine * load.force.norm();
}

// Adds a sleeper to the groups above the level: it joins those it bears, and opens the pairs below it.
void addToGroups(Simulation& simulation, std::int32_t block, const Vec3& up) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& path = engine.scratch.support;
  path.parent[static_cast<std::size_t>(block)] = block;
  forEachPair(engine, block, [&](std::int32_t at, const BlockPair& pair) {
    const std::int32_t other = pair.a == block ? pair.b : pair.a;
    if (other < 0 || path.parent[static_cast<std::size_t>(other)] < 0) {
      path.open.push_back(at);
      return;
    }
    if (!isVertical(sleepLoadOf(engine, static_cast<std::size_t>(at)), up)) return;
    const std::int32_t into = findRoot(path.parent, block);
    const std::int32_t from = findRoot(path.parent, other);
    if (into == from) return;
    path.parent[static_cast<std::size_t>(from)] = into;
    LoadChange& sum = engine.scratch.loadChange[static_cast<std::size_t>(into)];
    sum.force += engine.scratch.loadChange[static_cast<std::size_t>(from)].force;
    sum.torque += engine.scratch.loadChange[static_cast<std::size_t>(from)].torque;
  });
}

bool isAbove(const SupportCheckScratch& path, std::int32_t block) {
  return block >= 0 && path.parent[static_cast<std::size_t>(block)] >= 0;
}

// Lists the groups above the level that are pushed, and the pairs on which each may rest, group by group.
void listPushedGroups(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& path = engine.scratch.support;
  path.groups.clear();
  for (const std::int32_t block : engine.scratch.pushed) {
    if (isAbove(path, block)) path.groups.push_back(findRoot(path.parent, block));
  }
  std::sort(path.groups.begin(), path.groups.end());
  path.groups.erase(std::unique(path.groups.begin(), path.groups.end()), path.groups.end());
  path.beneath.clear();
  for (const std::int32_t at : path.open) {
    const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(at)];
    const std::int32_t group = findRoot(path.parent, isAbove(path, pair.a) ? pair.a : pair.b);
    if (std::binary_search(path.groups.begin(), path.groups.end(), group)) path.beneath.push_back({group, at});
  }
  std::sort(path.beneath.begin(), path.beneath.end());
}

// The points on which a group above the level rests, seen from their middle, which is returned.
Vec3 findSupports(Simulation& simulation, std::span<const SupportPair> beneath, const Vec3& up) {
  SupportCheckScratch& path = simulation.engine->scratch.support;
  path.supports.clear();
  const Scene& scene = simulation.scene;
  Vec3 middle = Vec3::Zero();
  for (const SupportPair& of : beneath) {
    const BlockPair& pair = simulation.engine->pairs.key[static_cast<std::size_t>(of.pair)];
    const ContactView contact = contactOf(*simulation.engine, static_cast<std::size_t>(of.pair));
    const std::int32_t above = isAbove(path, pair.a) ? pair.a : pair.b;
    const PointForces points = forcesNow(simulation, contact);
    const double sense = contact.upper == above ? 1.0 : -1.0;
    if (!(sense * points.direction.dot(up) > tuning::kSupportCosine)) continue;
    const bool awake = !sleeps(simulation, pair.a == above ? pair.b : pair.a);
    for (std::size_t i = 0; i < static_cast<std::size_t>(contact.count); ++i) {
      if (!(points.normal[i] > 0.0)) continue;
      const Vec3 friction{points.friction[i][0], points.friction[i][1], points.friction[i][2]};
      SupportPoint point;
      point.arm = points.place[i];
      point.normal = sense * points.direction;
      point.force = sense * (points.normal[i] * points.direction + friction);
      point.friction = scene.staticFriction;
      if (awake && friction.norm() > tuning::kAwakeSlidingShare * scene.kineticFriction * points.normal[i]) {
        point.state = SupportState::slip;
        point.slide = sense * friction;
        point.friction = scene.kineticFriction;
      }
      path.supports.push_back(point);
      middle += point.arm;
    }
  }
  if (!path.supports.empty()) middle /= static_cast<double>(path.supports.size());
  for (SupportPoint& point : path.supports) point.arm -= middle;
  return middle;
}

// Whether a group above the level stays on what bears it.
bool supportHolds(Simulation& simulation, std::int32_t group, std::span<const SupportPair> beneath, const Vec3& up) {
  const LoadChange& change = simulation.engine->scratch.loadChange[static_cast<std::size_t>(group)];
  std::vector<SupportPoint>& supports = simulation.engine->scratch.support.supports;
  const double height = simulation.lengths.blockHeight_m;
  const Vec3 middle = findSupports(simulation, beneath, up);
  if (supports.empty()) return true;  // it rests on awake blocks alone, and was asked above them
  const Vec3 torque = change.torque - middle.cross(change.force);
  double borne = 0.0;
  for (const SupportPoint& point : supports) borne += point.normal.dot(point.force);
  if (change.force.norm() <= tuning::kMinGroupLoadChange * borne && torque.norm() <= tuning::kMinGroupLoadChange * borne * height)
    return true;
  return redistribute(supports, change.force, torque, height, simulation.scene.settings.tangentialRatio);
}

// Whether the same blocks were pushed in much the same way when all stayed last; if not, that is how they are pushed now.
bool isKnownToStay(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  std::vector<CheckedLoad>& known = engine.sleep.checkedLoads;
  const bool same = std::equal(known.begin(), known.end(), engine.scratch.pushed.begin(), engine.scratch.pushed.end(),
                               [&](const CheckedLoad& before, std::int32_t block) {
                                 const auto b = static_cast<std::size_t>(block);
                                 const LoadChange& now = engine.scratch.loadChange[b];
                                 const double most = tuning::kRepeatLoadChange * now.load_n;
                                 return before.block == block && (now.force - before.force).norm() <= most &&
                                        (now.torque - before.torque).norm() <= most * simulation.model.dimensions[b].minCoeff();
                               });
  if (same) return true;
  known.clear();
  for (const std::int32_t block : engine.scratch.pushed) {
    const LoadChange& now = engine.scratch.loadChange[static_cast<std::size_t>(block)];
    known.push_back({block, now.force, now.torque});
  }
  return false;
}

}  // namespace

bool findFailedSupports(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  SupportCheckScratch& path = engine.scratch.support;
  if (engine.sleep.gravity.isZero(0.0) || isKnownToStay(simulation)) return false;
  const Vec3 up = -engine.sleep.gravity.normalized();
  listPairsOfSleepers(simulation);
  listSleepers(simulation, up);
  path.parent.assign(simulation.asleep.size(), -1);
  path.open.clear();
  bool gives = false;
  std::size_t above = 0;  // how many blocks are above the level
  while (above < path.blocks.size()) {
    const double level = heightOf(simulation, path.blocks[above], up) - tuning::kLevelHeight * simulation.lengths.blockHeight_m;
    for (; above < path.blocks.size() && heightOf(simulation, path.blocks[above], up) > level; ++above) {
      addToGroups(simulation, path.blocks[above], up);
    }
    const auto isOver = [&](std::int32_t block) { return block >= 0 && heightOf(simulation, block, up) > level; };
    std::erase_if(path.open, [&](std::int32_t at) {
      const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(at)];
      return isOver(pair.a) && isOver(pair.b);
    });
    listPushedGroups(simulation);
    const auto beneathOf = [&](std::int32_t group) {
      const auto first = std::lower_bound(path.beneath.begin(), path.beneath.end(), SupportPair{group, 0});
      const auto last = std::lower_bound(first, path.beneath.end(), SupportPair{group + 1, 0});
      return std::span<const SupportPair>(first, last);
    };
    for (const std::int32_t group : path.groups) {
      if (supportHolds(simulation, group, beneathOf(group), up)) continue;
      gives = true;
      engine.sleep.checkedLoads.clear();
      for (std::size_t i = 0; i < above; ++i) {
        if (findRoot(path.parent, path.blocks[i]) == group)
          engine.scratch.toWake.push_back({path.blocks[i], WakeReason::failedSupport});
      }
    }
  }
  return gives;
}

}  // namespace springtower

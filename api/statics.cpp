#include "solver/statics/statics.h"

#include "api/convert.h"
#include "api/world_impl.h"
#include "core/limits.h"
#include "core/scene/remove_block.h"

#include <cmath>
#include <fmt/format.h>
#include <springtower/statics.h>

namespace springtower::api {
namespace {

constexpr std::size_t kMaxStaticBlocks = 1000;

// A scene that statics can analyse, without the user's forces.
springtower::Scene checkedForStatics(const Scene& scene) {
  springtower::Scene blocks = toEngine(scene);
  const std::string source = sourceOf(scene);
  springtower::checkScene(blocks, source);
  if (blocks.blocks.size() > kMaxStaticBlocks) {
    throw InputError(
        fmt::format("{}: expected 1 to {} blocks for statics, got {}", source, kMaxStaticBlocks, blocks.blocks.size()));
  }
  if (!(blocks.gravity.magnitude > 0.0))
    throw InputError(fmt::format("{}: expected gravity above 0 for statics, got none", source));
  blocks.forces.clear();
  return blocks;
}

StaticScene analysed(const Scene& scene) {
  return staticScene(checkedForStatics(scene));
}

Verdict verdictOf(Rest rest) {
  return rest == Rest::stands ? Verdict::stands : rest == Rest::leans ? Verdict::leans : Verdict::falls;
}

}  // namespace

Verdict verdict(const Scene& scene) {
  return withPublicErrors([&] { return verdictOf(analysed(scene).rest); });
}

Verdict verdictWithout(const Scene& scene, int block) {
  return withPublicErrors([&] {
    springtower::Scene blocks = checkedForStatics(scene);
    const std::size_t left = checkedBlock(block, blocks.blocks.size());
    if (blocks.blocks.size() < 2)
      throw InputError(fmt::format("{}: expected at least two blocks to leave one out, got one", sourceOf(scene)));
    removeBlock(blocks, left);
    return verdictOf(staticScene(blocks).rest);
  });
}

std::optional<StabilityMargin> stabilityMargin(const Scene& scene) {
  return withPublicErrors([&]() -> std::optional<StabilityMargin> {
    const auto margin = tiltMargin(analysed(scene));
    if (!margin) return {};
    return StabilityMargin{margin->tilt_deg, margin->direction_deg};
  });
}

std::optional<Loads> loads(const Scene& scene) {
  return withPublicErrors([&]() -> std::optional<Loads> {
    const StaticScene analysis = analysed(scene);
    if (analysis.rest == Rest::falls) return {};
    const ContactLoads contactForces = contactLoads(analysis);
    Loads result;
    result.anyOfMany = contactForces.anyOfMany;
    for (const ContactLoad& contact : contactForces.contacts) {
      result.contacts.push_back({static_cast<int>(contact.upper), static_cast<int>(contact.lower), toPublic(contact.force),
                                 toPublic(contact.place), contact.normal_n, contact.frictionUsed});
    }
    for (const springtower::BlockLoad& load : blockLoads(analysis, contactForces)) {
      result.blocks.push_back(
          {load.weight_n, load.above_n, load.leastAbove_n, load.greatestAbove_n, load.covered, load.loose, load.gap_m});
    }
    return result;
  });
}

std::optional<double> pullLimit(const Scene& scene, int block, const Vec3& direction) {
  return withPublicErrors([&]() -> std::optional<double> {
    const springtower::Scene blocks = checkedForStatics(scene);
    const std::size_t b = checkedBlock(block, blocks.blocks.size());
    const springtower::Vec3 along = toEngine(direction);
    const double length = along.stableNorm();
    if (!(length > 0.0) || !std::isfinite(length))
      throw InputError(fmt::format("direction: expected a finite length above 0, got {}", length));
    return springtower::pullLimit(staticScene(blocks), blockId(b), along / length);
  });
}

}  // namespace springtower::api

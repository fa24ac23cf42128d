#include "apps/commands/validate/removals.h"

#include "apps/commands/verdict/json.h"
#include "apps/commands/verdict/json_object.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"
#include "scenarios/towers.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

namespace springtower {
namespace {

// Every place is that of a block, and none is there twice.
void checkPlaces(const Removals& removals, const std::string& where) {
  std::vector<BlockSpec> left = removals.scene.blocks;
  for (const Removals::Place& place : removals.removed) {
    const auto taken = std::find_if(left.begin(), left.end(), [&](const BlockSpec& block) {
      return block.row == place.row && block.position == place.position;
    });
    if (taken == left.end()) {
      throw InputError(fmt::format("{}: remove: expected places where a block is left, got row {}, position {}", where, place.row,
                                   place.position));
    }
    left.erase(taken);
  }
}

Removals removalsOf(const std::string& text, const std::string& where) {
  const nlohmann::ordered_json line = parseVerdictLine(text, where);
  const JsonObject object(line, where, {"id", "config", "remove", "stands_after"});
  Removals removals{object.text("id"), {}, {}, object.flags("stands_after")};
  try {
    removals.scene = bitCodeScene(object.text("config"));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: config: {}", where, error.what()));
  }
  for (const JsonObject& place : object.list("remove", {"row", "position"})) {
    removals.removed.push_back({place.wholeNumber("row", 0, kMaxRows - 1), place.wholeNumber("position", 1, 3)});
  }
  if (removals.standsAfter.size() != removals.removed.size() + 1) {
    throw InputError(fmt::format("{}: stands_after: expected {} verdicts, one and one more for each removal, got {}", where,
                                 removals.removed.size() + 1, removals.standsAfter.size()));
  }
  checkPlaces(removals, where);
  return removals;
}

}  // namespace

std::vector<Removals> readRemovals(const std::string& folder, std::size_t most) {
  LineInput file(folder + "/removal.jsonl", "--oracle");
  std::vector<Removals> all;
  for (std::string text; all.size() < most && file.next(text);) {
    if (!isBlankLine(text)) all.push_back(removalsOf(text, "--oracle: " + file.where()));
  }
  return all;
}

}  // namespace springtower

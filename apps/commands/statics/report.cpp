#include "apps/commands/statics/report.h"

#include "apps/common/json_values.h"
#include "core/limits.h"
#include "core/version.h"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// JSON has no infinity.
Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

// Without a sign before what prints as zero.
double shownMillimetres(double value_m) {
  return std::abs(value_m) < 5e-6 ? 0.0 : kMillimetres * value_m;
}

// Row and position of a tower's block, or its number.
std::string placeOf(const Scene& scene, BlockId id) {
  if (id == kFloor) return "floor";
  const BlockSpec& block = scene.blocks[index(id)];
  return block.row < 0 ? fmt::format("{}", index(id)) : fmt::format("{}:{}", block.row, block.position);
}

Json contactJson(const StaticsAnswer& answer, std::size_t c) {
  const ContactLoad& contact = answer.loads.contacts[c];
  const FacePair& facing = answer.statics.facings[c];
  Json points = Json::array();
  for (std::size_t p = 0; p < facing.points.size(); ++p) {
    points.push_back({{"place_m", vectorJson(facing.points[p].place)},
                      {"gap_mm", kMillimetres * facing.points[p].gap_m},
                      {"force_n", vectorJson(contact.pointForces[p])}});
  }
  return {{"upper", blockJson(contact.upper)},
          {"lower", blockJson(contact.lower)},
          {"normal_n", contact.normal_n},
          {"force_n", vectorJson(contact.force)},
          {"place_m", vectorJson(contact.place)},
          {"friction_used", contact.frictionUsed},
          {"points", points}};
}

void printBlocks(const Scene& scene, const StaticsAnswer& answer) {
  const bool loads = !answer.blocks.empty();
  const bool removals = !answer.removals.empty();
  if (!loads && !removals) return;
  fmt::print("\n{:>9}", "block");
  if (loads) fmt::print("{:>10}{:>10}{:>10}{:>10}   {:<14}", "weight N", "load N", "min", "max", "above");
  if (removals) fmt::print("   {:<22}{:>9}{:>9}", "if removed", "tilt deg", "towards");
  fmt::print("\n");
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    fmt::print("{:>9}", placeOf(scene, blockId(b)));
    if (loads) {
      const BlockLoad& load = answer.blocks[b];
      const std::string greatest = load.greatestAbove_n ? fmt::format("{:.4f}", *load.greatestAbove_n) : "no limit";
      const std::string above = !load.covered ? "nothing"
                                : load.loose  ? fmt::format("loose {:.3f} mm", kMillimetres * load.gap_m)
                                              : "loaded";
      fmt::print("{:>10.4f}{:>10.4f}{:>10.4f}{:>10}   {:<14}", load.weight_n, load.above_n, load.leastAbove_n, greatest, above);
    }
    if (removals) {
      const std::optional<Removal>& removal = answer.removals[b];
      fmt::print("   {:<22}", removal ? nameOf(removal->rest) : "not known");
      if (removal && removal->margin) fmt::print("{:>9.2f}{:>9.0f}", removal->margin->tilt_deg, removal->margin->direction_deg);
    }
    fmt::print("\n");
  }
}

void printContacts(const Scene& scene, const StaticsAnswer& answer) {
  fmt::print("\n{:>9}{:>9}{:>12}{:>12}{:>10}{:>10}{:>10}{:>15}\n", "upper", "lower", "normal N", "friction N", "x mm", "y mm",
             "z mm", "friction used");
  for (const ContactLoad& contact : answer.loads.contacts) {
    const double sideways = std::sqrt(std::max(0.0, contact.force.squaredNorm() - contact.normal_n * contact.normal_n));
    fmt::print("{:>9}{:>9}{:>12.5f}{:>12.5f}{:>10.2f}{:>10.2f}{:>10.2f}{:>13.1f} %\n", placeOf(scene, contact.upper),
               placeOf(scene, contact.lower), contact.normal_n, sideways, shownMillimetres(contact.place.x()),
               shownMillimetres(contact.place.y()), shownMillimetres(contact.place.z()), 100.0 * contact.frictionUsed);
  }
}

}  // namespace

std::string_view nameOf(Rest rest) {
  switch (rest) {
    case Rest::stands:
      return "stands";
    case Rest::leans:
      return "stands after leaning";
    case Rest::falls:
      break;
  }
  return "falls";
}

Json restJson(Rest rest, const std::optional<StabilityMargin>& margin) {
  Json json;
  json["stands"] = rest != Rest::falls;
  json["leans"] = rest == Rest::leans;
  json["tilt_deg"] = margin ? Json(margin->tilt_deg) : Json(nullptr);
  json["tilt_direction_deg"] = margin ? Json(margin->direction_deg) : Json(nullptr);
  return json;
}

Json staticsJson(const Scene& scene, const StaticsAnswer& answer) {
  Json json;
  json["version"] = kVersion;
  json["scene"] = scene.name;
  json["friction"] = scene.staticFriction;
  json["gravity_tilt_deg"] = scene.gravity.tilt_deg;
  json["gravity_direction_deg"] = scene.gravity.direction_deg;
  json.update(restJson(answer.statics.rest, answer.margin));
  json["settlement_mm"] = kMillimetres * answer.statics.settlement_m;
  json["interrupted"] = answer.interrupted;
  json["forces_are"] = answer.blocks.empty()    ? Json(nullptr)
                       : answer.loads.anyOfMany ? Json("any that balance")
                                                : Json("least squares");
  json["wall_s"] = answer.wall_s;
  Json blocks = Json::array();
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    Json block = {{"block", b}};
    if (scene.blocks[b].row >= 0) {
      block["row"] = scene.blocks[b].row;
      block["position"] = scene.blocks[b].position;
    }
    if (!answer.blocks.empty()) {
      const BlockLoad& load = answer.blocks[b];
      block["weight_n"] = load.weight_n;
      block["above_n"] = load.above_n;
      block["least_above_n"] = load.leastAbove_n;
      block["greatest_above_n"] = load.greatestAbove_n ? Json(*load.greatestAbove_n) : Json(nullptr);
      block["covered"] = load.covered;
      block["loose"] = load.loose;
      block["gap_mm"] = kMillimetres * load.gap_m;
    }
    if (!answer.removals.empty() && answer.removals[b])
      block["removal"] = restJson(answer.removals[b]->rest, answer.removals[b]->margin);
    blocks.push_back(std::move(block));
  }
  json["blocks"] = std::move(blocks);
  Json contacts = Json::array();
  for (std::size_t c = 0; c < answer.loads.contacts.size(); ++c) contacts.push_back(contactJson(answer, c));
  json["contacts"] = std::move(contacts);
  Json pulls = Json::array();
  for (const PullAnswer& pull : answer.pulls) {
    pulls.push_back({{"block", index(pull.block)},
                     {"axis", pull.axis},
                     {"limit_n", pull.limit_n ? finite(*pull.limit_n) : Json(nullptr)},
                     {"unlimited", pull.limit_n && std::isinf(*pull.limit_n)}});
  }
  json["pulls"] = std::move(pulls);
  return json;
}

void printStatics(const Scene& scene, const StaticsAnswer& answer, bool contacts) {
  const auto line = [](std::string_view name, const std::string& value) { fmt::print("{:<12}{}\n", name, value); };
  line("scene", fmt::format("{}: {} blocks, friction {}", onOneLine(scene.name), scene.blocks.size(), scene.staticFriction));
  if (scene.gravity.tilt_deg != 0.0) {
    line("gravity", fmt::format("tilted by {} deg towards {} deg", scene.gravity.tilt_deg, scene.gravity.direction_deg));
  }
  line("verdict", std::string(nameOf(answer.statics.rest)));
  if (answer.statics.rest == Rest::leans) {
    line("leaning",
         fmt::format("a block moves by up to {:.3f} mm until more touches", kMillimetres * answer.statics.settlement_m));
  }
  if (!answer.margin) {
    line("margin", "none: it would fall under gravity of any tilt");
  } else if (answer.margin->tilt_deg >= 0.0) {
    line("margin", fmt::format("{:.2f} deg: gravity may turn so far towards its worst side, {:.0f} deg from +x over +y",
                               answer.margin->tilt_deg, answer.margin->direction_deg));
  } else {
    line("margin", fmt::format("{:.2f} deg: it would stand if gravity turned by {:.2f} deg towards {:.0f} deg from +x over +y",
                               answer.margin->tilt_deg, -answer.margin->tilt_deg, answer.margin->direction_deg));
  }
  if (answer.statics.rest != Rest::falls) {
    line("forces", answer.loads.anyOfMany ? "any that balance" : "of those that balance, the ones of least squares");
  }
  for (const PullAnswer& pull : answer.pulls) {
    const std::string limit = !pull.limit_n               ? "none, the scene falls"
                              : std::isinf(*pull.limit_n) ? "unlimited"
                                                          : fmt::format("at most {:.4f} N", *pull.limit_n);
    line("pull", fmt::format("block {} along {}: {}", placeOf(scene, pull.block), pull.axis, limit));
  }
  printBlocks(scene, answer);
  if (contacts && !answer.loads.contacts.empty()) printContacts(scene, answer);
}

}  // namespace springtower

#include "apps/commands/validate/kept.h"

#include "apps/commands/validate/page.h"
#include "core/hash.h"
#include "core/limits.h"
#include "core/whole_file.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// Of the reference sets and scenes: other towers under the same names are another validation.
std::string hashOfInputs(const ValidationPlan& plan) {
  std::vector<std::filesystem::path> files;
  for (const std::string& folder : {plan.oracle, plan.scenes}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::filesystem::path ending = entry.path().extension();
      if (entry.is_regular_file() && (ending == ".jsonl" || ending == ".toml")) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  Hash hash;
  for (const std::filesystem::path& file : files) {
    const std::string text = wholeFile(file.string(), onOneLine(file.string()));
    hash.bytes(text.data(), text.size());
    hash.word(text.size());
  }
  return fmt::format("{:016x}", hash.value());
}

ValidationSection sectionFrom(const Json& json) {
  ValidationSection section{json.at("title").get<std::string>(), json.at("text").get<std::string>()};
  for (const Json& claim : json.at("claims")) {
    const Json& passed = claim.at("passed");
    section.claims.push_back({claim.at("claim").get<std::string>(), claim.at("tolerance").get<std::string>(),
                              claim.at("measured").get<std::string>(),
                              passed.is_null() ? std::optional<bool>{} : std::optional<bool>{passed.get<bool>()}});
  }
  for (const Json& figure : json.at("figures")) {
    ValidationFigure& kept = section.figures.emplace_back();
    figure.at("name").get_to(kept.name);
    figure.at("title").get_to(kept.plot.title);
  }
  json.at("notes").get_to(section.notes);
  json.at("wall_s").get_to(section.wall_s);
  return section;
}

}  // namespace

void writeKeptParts(std::ostream& stream, std::span<const KeptPart> parts, const ValidationPlan& plan,
                    const Provenance& provenance) {
  Json json = provenanceJson(provenance);
  json["long_form"] = plan.longForm;
  json["inputs"] = hashOfInputs(plan);
  json["parts"] = Json::array();
  for (const KeptPart& part : parts) {
    Json figures = Json::array();
    for (const ValidationFigure& figure : part.section.figures) {
      figures.push_back({{"name", figure.name}, {"title", figure.plot.title}});
    }
    json["parts"].push_back({{"part", part.name},
                             {"title", part.section.title},
                             {"text", part.section.text},
                             {"wall_s", part.section.wall_s},
                             {"claims", claimsJson(part.section)},
                             {"figures", figures},
                             {"notes", part.section.notes}});
  }
  stream << json.dump(2) << '\n';
}

std::vector<KeptPart> readKeptParts(const std::string& path, const ValidationPlan& plan, const Provenance& provenance) {
  std::vector<KeptPart> parts;
  readKept(path, provenance, {{"long_form", plan.longForm}, {"inputs", hashOfInputs(plan)}}, [&](const Json& json) {
    for (const Json& part : json.at("parts")) parts.push_back({part.at("part").get<std::string>(), sectionFrom(part)});
  });
  return parts;
}

}  // namespace springtower

#include "apps/commands/validate/page.h"

#include <fmt/format.h>
#include <fmt/ostream.h>
#include <nlohmann/json.hpp>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// Text for a cell of a table.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string bold(const Claim& claim) {
  const std::string_view result = resultOf(claim);
  return result == "fail" ? "**fail**" : std::string(result);
}

void writeClaims(std::ostream& stream, const ValidationSection& section) {
  stream << "| claim | tolerance | measured | result |\n|---|---|---|---|\n";
  for (const Claim& claim : section.claims) {
    fmt::print(stream, "| {} | {} | {} | {} |\n", cell(claim.what), cell(claim.tolerance), cell(claim.measured), bold(claim));
  }
}

}  // namespace

ClaimCounts countClaims(std::span<const ValidationSection> sections) {
  ClaimCounts counts;
  for (const ValidationSection& section : sections) {
    for (const Claim& claim : section.claims) ++(!claim.passed ? counts.reported : *claim.passed ? counts.passed : counts.failed);
  }
  return counts;
}

std::string_view resultOf(const Claim& claim) {
  return !claim.passed ? "-" : *claim.passed ? "pass" : "fail";
}

nlohmann::ordered_json claimsJson(const ValidationSection& section) {
  Json claims = Json::array();
  for (const Claim& claim : section.claims) {
    claims.push_back({{"claim", claim.what},
                      {"tolerance", claim.tolerance},
                      {"measured", claim.measured},
                      {"passed", claim.passed ? Json(*claim.passed) : Json(nullptr)}});
  }
  return claims;
}

void writeValidationPage(std::ostream& stream, std::span<const ValidationSection> sections, const ValidationPlan& plan,
                         const Provenance& provenance) {
  const ClaimCounts counts = countClaims(sections);
  stream << "# Validation of Springtower\n\n";
  fmt::print(stream, "{} form: {} claims hold, {} fail; {} figures are reported without a limit.\n\n{}\n\n",
             plan.longForm ? "Full" : "Short", counts.passed, counts.failed, counts.reported, footnote(provenance));
  if (counts.failed > 0) {
    stream << "## What fails\n\n| part | claim | tolerance | measured |\n|---|---|---|---|\n";
    for (const ValidationSection& section : sections) {
      for (const Claim& claim : section.claims) {
        if (claim.passed.value_or(true)) continue;
        fmt::print(stream, "| {} | {} | {} | {} |\n", section.title, cell(claim.what), cell(claim.tolerance),
                   cell(claim.measured));
      }
    }
    stream << '\n';
  }
  for (const ValidationSection& section : sections) {
    fmt::print(stream, "## {}\n\n{}\n\n", section.title, section.text);
    writeClaims(stream, section);
    stream << '\n';
    for (const std::string& note : section.notes) fmt::print(stream, "- {}\n", note);
    if (!section.notes.empty()) stream << '\n';
    for (const ValidationFigure& figure : section.figures) {
      fmt::print(stream, "![{}]({}.svg)\n\n", figure.plot.title, figure.name);
    }
    fmt::print(stream, "Measured in {:.1f} s.\n\n", section.wall_s);
  }
  stream << "## The requirements of the 2003 report (its section 3.6)\n\n| | requirement | shown by |\n|---|---|---|\n";
  for (const Requirement& requirement : reportRequirements()) {
    fmt::print(stream, "| {} | {} | {} |\n", requirement.number, cell(requirement.text), cell(requirement.shownBy));
  }
}

void writeValidationJson(std::ostream& stream, std::span<const ValidationSection> sections, const ValidationPlan& plan,
                         const Provenance& provenance) {
  const ClaimCounts counts = countClaims(sections);
  Json json = provenanceJson(provenance);
  json["long_form"] = plan.longForm;
  json["passed"] = counts.passed;
  json["failed"] = counts.failed;
  json["reported"] = counts.reported;
  json["sections"] = Json::array();
  for (const ValidationSection& section : sections) {
    json["sections"].push_back(
        {{"title", section.title}, {"wall_s", section.wall_s}, {"claims", claimsJson(section)}, {"notes", section.notes}});
  }
  stream << json.dump(2) << '\n';
}

}  // namespace springtower

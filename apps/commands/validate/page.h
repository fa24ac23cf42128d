#pragma once

#include "apps/commands/validate/validate.h"
#include "apps/common/provenance.h"

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>

namespace springtower {

/// Claims by what became of them.
struct ClaimCounts {
  std::size_t passed = 0;
  std::size_t failed = 0;
  std::size_t reported = 0;
};
ClaimCounts countClaims(std::span<const ValidationSection> sections);

/// "pass", "fail", or "-" for what is only reported.
std::string_view resultOf(const Claim& claim);

/// The claims of a section as JSON: claim, tolerance, measured, passed (null for what is only reported).
nlohmann::ordered_json claimsJson(const ValidationSection& section);

/// The page: what failed first, then every section with its claims and figures, then the report's requirements.
void writeValidationPage(std::ostream& stream, std::span<const ValidationSection> sections, const ValidationPlan& plan,
                         const Provenance& provenance);

/// The same claims as JSON.
void writeValidationJson(std::ostream& stream, std::span<const ValidationSection> sections, const ValidationPlan& plan,
                         const Provenance& provenance);

}  // namespace springtower

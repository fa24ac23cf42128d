#pragma once

#include "apps/commands/validate/validate.h"
#include "apps/common/provenance.h"

#include <iosfwd>
#include <span>
#include <string>
#include <vector>

namespace springtower {

/// A part that is done and whose figures are written, for a run that goes on where one was broken off. Of the plots of its
/// figures the titles alone are kept.
struct KeptPart {
  std::string name;
  ValidationSection section;
};

/// What a run has done so far, as JSON. With it goes where it comes from: build, machine, form, and a hash of the files it read.
void writeKeptParts(std::ostream& stream, std::span<const KeptPart> parts, const ValidationPlan& plan,
                    const Provenance& provenance);

/// Reads such a file; nothing where there is none. Throws InputError for a file that is none of these, or of another build,
/// machine, form or input or with uncommitted changes, so that it cannot be gone on with.
std::vector<KeptPart> readKeptParts(const std::string& path, const ValidationPlan& plan, const Provenance& provenance);

}  // namespace springtower

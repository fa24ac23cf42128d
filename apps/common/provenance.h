#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace springtower {

/// What a timing has to be quoted with.
struct Provenance {
  std::string version;
  std::string commit;  ///< as in core/version.h, with -dirty after it where there were uncommitted changes
  std::string compiler;
  std::string flags;
  std::string buildType;
  std::string processor;    ///< the processor's own name, "unknown" where the system does not name it
  unsigned processors = 0;  ///< that this program may run on
  std::string date;         ///< UTC, as 2003-05-01T12:00:00Z
};

/// That of this build, on this machine, now.
Provenance provenanceNow();

nlohmann::ordered_json provenanceJson(const Provenance& provenance);
/// Back from JSON. Throws nlohmann::json::exception when a key is missing or has another type.
Provenance provenanceFromJson(const nlohmann::ordered_json& json);

/// Whether results of both may stand beside each other: the same version, commit, compiler, flags, build type and processor.
bool sameOrigin(const Provenance& a, const Provenance& b);

/// Whether an earlier run may be gone on with as far as its build is concerned: throws InputError with the reason when one of
/// both builds has uncommitted changes, of which its commit says nothing. `where` begins the message.
void checkCommitted(const Provenance& then, const Provenance& now, const std::string& where);

/// Hands the JSON file that an earlier run has left to `read`, to go on from there; does nothing where there is no such file.
/// `settings`: the keys whose values decide what is measured, as they are in this run. Throws InputError naming the file for one
/// that this version does not write, and for one of another build, machine or settings.
void readKept(const std::string& path, const Provenance& now, const nlohmann::ordered_json& settings,
              const std::function<void(const nlohmann::ordered_json&)>& read);

/// Commit, compiler, flags, processor and date, as the last columns of a line of CSV.
std::string csvText(const Provenance& provenance);

/// One line for the foot of a chart.
std::string footnote(const Provenance& provenance);

}  // namespace springtower

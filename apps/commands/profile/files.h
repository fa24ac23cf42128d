#pragma once

#include "apps/commands/profile/measure.h"
#include "apps/commands/profile/profile.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace springtower {

/// All figures of a profile, as JSON; numbers are written in full.
void writeProfileJson(std::ostream& stream, const Profile& profile);

/// Reads such a file. Throws InputError naming the file and what is wrong with it.
Profile readProfileJson(const std::string& path);

/// One line for each case, with a line of names before them: times in ms, stages in ms a frame, counters a frame, bytes a block,
/// and on every line the commit, compiler, flags, processor and date.
void writeProfileCsv(std::ostream& stream, const Profile& profile);

/// The timed frames of the last samples in Chrome's trace format, which Perfetto opens: a process for each scene, a thread for
/// each case, on it the frames and inside them the stages. A frame's stages are sums: they are drawn one after the other from the
/// frame's start, and where threads work side by side shrunk to fit; `ms` of each says what was measured.
void writeTrace(std::ostream& stream, const Provenance& provenance, const std::vector<TracedCase>& traced);

}  // namespace springtower

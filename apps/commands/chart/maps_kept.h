#pragma once

#include "apps/commands/chart/maps.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace springtower {

/// Writes the rows of maps that have been measured so far, for a later run to go on with.
void writeKeptRows(std::ostream& stream, const std::vector<MapRow>& rows, const MapLimits& limits, const Provenance& provenance);

/// Those that an earlier run has left in a file; none where there is no such file. Throws InputError naming it for one that is
/// none, or of another build, machine or limits.
std::vector<MapRow> readKeptRows(const std::string& path, const MapLimits& limits, const Provenance& provenance);

}  // namespace springtower

#pragma once

#include "solver/runner/run.h"

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace springtower {

/// What the scene's moves did, one object a move: how far each other block of the tower is moved, and what statics says of the
/// new set of blocks.
nlohmann::ordered_json movesJson(const Simulation& simulation, const RunResult& result);

/// Prints a line a move, then how far each other block moved in each of them.
void printMoves(const Simulation& simulation, const RunResult& result);

/// "take 3-1" or "put 7-2": a move in a few words, rows counted from 0 as in scene files.
std::string describe(const Move& move);

}  // namespace springtower

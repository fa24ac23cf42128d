#pragma once

#include <string>

namespace springtower {

/// What `springtower statics` does with a list of towers, FILE.jsonl or - for standard input: lines as `verdict` reads them, and
/// with `remove` (a list of {row, position}, taken out one after the other) and perhaps `stands_after` (what is expected at the
/// start and after each). Solves them in parallel on `threads` threads and prints one JSON object for each, in their order, as
/// soon as it and those before it are known: id, stands, leans, tilt_deg, tilt_direction_deg, and stands_after for sequences.
/// With `check` the agreement goes to standard error: of the verdict on clear lines and of all states of sequences, and of the
/// tilt of clear lines within 0.1 degrees. Returns the exit code: 1 when one of them differs, 2 when lines were bad and left out
/// (`keepGoing`), that of a signal when one has come. For a tower that falls the tilt is a distance from standing, which is
/// counted on a line of its own and not judged. Throws InputError for a bad line without `keepGoing`, when those before it are
/// printed.
int executeStaticsList(const std::string& file, bool check, bool keepGoing, int threads);

}  // namespace springtower

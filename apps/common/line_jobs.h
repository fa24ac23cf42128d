#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace springtower {

class LineReader;

/// What one line calls for: done by any thread, it returns the text to print. It throws InputError where the line turns out to be
/// bad, and Interrupted (interruption.h) when a signal has come.
using LineJob = std::function<std::string()>;

/// Makes a job of a line, or an empty one of a line that is to be skipped. Called in the order of the lines, by one thread at a
/// time. `where` begins messages: "FILE: line 7". Throws InputError for a bad line.
using LineParser = std::function<LineJob(const std::string& line, std::size_t number, const std::string& where)>;

/// What became of a list.
struct LineCounts {
  std::size_t lines = 0;     ///< that were not skipped, bad ones included
  std::size_t bad = 0;       ///< left out, with a complaint each
  bool interrupted = false;  ///< a signal came before all was done
};

/// Works off the lines of an input on `threads` threads, in the order in which they come, and prints each text on standard output
/// as soon as it and all before it are done. So what is printed is at any time the beginning of what will have been printed in
/// the end. A bad line ends the work with its InputError, when those before it are done and printed; with `keepGoing` it is
/// reported on standard error and left out. A signal ends the work: what then is under way is not printed. Throws InputError
/// where standard output takes no more. Anything else that a job or the parser throws ends the work at once and is thrown on.
LineCounts workOffLines(LineReader& input, int threads, bool keepGoing, const LineParser& parse);

/// The exit code of a command that has worked off a list, `otherwise` where nothing came between: that of a signal, or that of
/// bad input when lines were left out, whose number is then reported on standard error.
int exitCodeOf(const LineCounts& counts, int otherwise);

}  // namespace springtower

#pragma once

namespace springtower {

/// From here on SIGINT and SIGTERM are noted instead of ending the program, which looks at `interrupted` at every frame, line or
/// case, keeps what is done, and ends with `interruptionExitCode`. A second signal ends it at once with that code; it is also
/// what ends a program that waits for the other end of a named pipe, but for the pipe of a list (line_reader.h). A signal that
/// the program was started to ignore stays ignored (as nohup and shells do for what runs in the background).
void noteInterruption();

/// Whether a signal has come. For any thread, and cheap: an atomic is read.
bool interrupted();

/// 130 after SIGINT, 143 after SIGTERM; 0 while none has come.
int interruptionExitCode();

/// Thrown by `endIfInterrupted`. No error: what was done before is kept, and the program ends with `interruptionExitCode`.
struct Interrupted {};

/// Throws Interrupted once a signal has come. For loops over frames and cases whose half-done results are of no use.
void endIfInterrupted();

}  // namespace springtower

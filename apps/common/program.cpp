#include "apps/common/program.h"

#include "apps/common/interruption.h"
#include "core/error.h"
#include "core/limits.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <fcntl.h>
#include <iostream>
#include <new>
#include <system_error>
#include <unistd.h>

namespace springtower {
namespace {

// The first file that a program opens takes the lowest free number. Where standard error was closed that would be 2, and
// complaints would end up in a report: so the three numbers are taken, in the direction that makes their use fail.
void takeStandardNumbers() {
  for (int number = STDIN_FILENO; number <= STDERR_FILENO; ++number) {
    if (fcntl(number, F_GETFD) != -1) continue;
    if (open("/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

bool flushed() {
  const bool c = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  return std::cout.flush() && c;
}

int guarded(std::string_view program, const std::function<int()>& work) {
  const auto end = [&](const std::string& message, int code) {
    complain(program, message);
    return code;
  };
  try {
    const int code = work();
    // A full disk or a closed pipe behind standard output must not pass unseen.
    return flushed() ? code : end("standard output: writing failed", kBadInput);
  } catch (const Interrupted&) {
    return flushed() ? interruptionExitCode() : end("standard output: writing failed", kBadInput);
  } catch (const InputError& error) {
    return end(error.what(), kBadInput);
  } catch (const DivergenceError& error) {
    return end(error.what(), kDiverged);
  } catch (const std::bad_alloc&) {
    return end("not enough memory for this scene", kBadInput);
  } catch (const std::system_error& error) {  // from printing, mostly
    return end(flushed() ? error.what() : "standard output: writing failed", kBadInput);
  } catch (const std::exception& error) {
    return end(error.what(), kProgramError);
  }
}

}  // namespace

void complain(std::string_view program, const std::string& message) {
  const std::string line = std::string(program) + ": " + onOneLine(message) + "\n";
  std::fwrite(line.data(), 1, line.size(), stderr);
}

int exitCodeOf(std::string_view program, const std::function<int()>& work) {
  takeStandardNumbers();
  std::signal(SIGPIPE, SIG_IGN);
  noteInterruption();
  try {
    return guarded(program, work);
  } catch (...) {  // no memory left for a complaint
    return kProgramError;
  }
}

}  // namespace springtower

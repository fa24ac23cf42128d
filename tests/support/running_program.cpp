#include "tests/support/running_program.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace springtower {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kLongest = 60s;

// Only calls that are safe between fork and exec.
bool connect(const std::string& path, int number, int flags) {
  if (path == kClosed) return close(number) == 0;
  const int file = open(path.c_str(), flags, 0600);
  return file >= 0 && dup2(file, number) == number && (file == number || close(file) == 0);
}

}  // namespace

RunningProgram::RunningProgram(std::string_view name, const std::vector<std::string>& arguments, const Streams& streams)
    : output_(streams.output.empty() ? scratch_.file("out") : streams.output),
      error_(streams.error.empty() ? scratch_.file("error") : streams.error) {
  const std::string program = std::string(SPRINGTOWER_BINARY_DIR) + "/bin/" + std::string(name);
  const std::string input = streams.input.empty() ? "/dev/null" : streams.input;
  std::vector<std::string> words = {std::string(name)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  process_ = fork();
  if (process_ < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (process_ == 0) {
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) std::signal(signal, SIG_DFL);
    if (connect(input, 0, O_RDONLY) && connect(output_, 1, O_WRONLY | O_CREAT) && connect(error_, 2, O_WRONLY | O_CREAT)) {
      execv(program.c_str(), pointers.data());
    }
    _exit(127);
  }
}

RunningProgram::~RunningProgram() {
  if (!isRunning()) return;
  send(SIGKILL);
  waitpid(process_, &status_, 0);
}

bool RunningProgram::isRunning() {
  if (process_ < 0) return false;
  if (waitpid(process_, &status_, WNOHANG) == 0) return true;
  process_ = -1;
  return false;
}

void RunningProgram::waitUntil(const std::function<bool()>& isTrue) {
  const Clock::time_point end = Clock::now() + kLongest;
  while (!isTrue()) {
    if (!isRunning()) throw std::runtime_error("the program has ended: " + contentOf(error_));
    if (Clock::now() > end) throw std::runtime_error("waited for a minute");
    std::this_thread::sleep_for(5ms);
  }
}

void RunningProgram::waitForFile(const std::string& path, std::size_t bytes) {
  waitUntil([&] {
    std::error_code none;
    const std::uintmax_t size = std::filesystem::file_size(path, none);
    return !none && size >= bytes;
  });
}

void RunningProgram::send(int signal) const {
  if (process_ > 0) kill(process_, signal);
}

ProgramResult RunningProgram::wait() {
  const Clock::time_point end = Clock::now() + kLongest;
  while (isRunning()) {
    if (Clock::now() > end) throw std::runtime_error("the program does not end");
    std::this_thread::sleep_for(5ms);
  }
  ProgramResult result;
  result.exitCode = WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
  // Of a device nothing is to be read, or no end.
  if (std::filesystem::is_regular_file(output_)) result.output = contentOf(output_);
  if (std::filesystem::is_regular_file(error_)) result.error = contentOf(error_);
  return result;
}

}  // namespace springtower

#include "tests/apps/viewer/app/display.h"

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;

namespace springtower {
namespace {

std::vector<char*> pointersTo(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::string pathOf(const std::string& program) {
  if (program.find('/') != std::string::npos) return program;
  return std::string(SPRINGTOWER_BINARY_DIR) + "/bin/" + program;
}

constexpr const char* kXvfb = "/usr/bin/Xvfb";
constexpr const char* kXdotool = "/usr/bin/xdotool";

}  // namespace

Background::Background(const std::string& program, const std::vector<std::string>& arguments,
                       const std::vector<std::string>& variables, const std::string& output) {
  const std::string path = pathOf(program);
  if (access(path.c_str(), X_OK) != 0) throw std::runtime_error("not there: " + path);
  std::vector<std::string> words = {path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> environment = variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('=') + 1);
    bool replaced = false;
    for (const std::string& given : variables) replaced = replaced || given.starts_with(name);
    if (!replaced) environment.push_back(text);
  }
  const std::vector<char*> argv = pointersTo(words);
  const std::vector<char*> envp = pointersTo(environment);
  process_ = fork();
  if (process_ < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (process_ > 0) return;
  const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int in = open("/dev/null", O_RDONLY);
  if (out >= 0 && in >= 0 && dup2(in, 0) == 0 && dup2(out, 1) == 1 && dup2(out, 2) == 2) {
    execve(path.c_str(), argv.data(), envp.data());
  }
  _exit(127);
}

Background::~Background() {
  if (!runs()) return;
  kill(process_, SIGTERM);
  if (wait(5.0) != -1000) return;
  kill(process_, SIGKILL);
  wait(5.0);
}

bool Background::runs() {
  if (process_ < 0) return false;
  int status = 0;
  if (waitpid(process_, &status, WNOHANG) != process_) return true;
  exitCode_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  process_ = -1;
  return false;
}

int Background::wait(double seconds) {
  waitUntil(seconds, [&] { return !runs(); });
  return exitCode_;
}

void Background::send(int signal) const {
  kill(process_, signal);
}

// Xvfb finds a free number itself and writes it to its standard output.
Display::Display(int width, int height)
    : server_(
          kXvfb,
          {"-displayfd", "1", "-screen", "0", std::to_string(width) + "x" + std::to_string(height) + "x24", "-nolisten", "tcp"},
          {}, scratch_.file("number")) {
  const auto number = [&] { return contentOf(scratch_.file("number")); };
  // Warnings of the server may stand before the number.
  const auto answered = [&] {
    for (const std::string& line : linesOf(number())) {
      if (!line.empty() && line.find_first_not_of("0123456789") == std::string::npos) name_ = ":" + line;
    }
    return !name_.empty();
  };
  if (!waitUntil(30.0, answered)) throw std::runtime_error("Xvfb does not answer: " + number());
}

void Display::act(std::string_view script) const {
  const std::string file = scratch_.file("script");
  std::ofstream(file) << script;
  Background tool(kXdotool, {file}, {variable()}, scratch_.file("tool"));
  if (tool.wait(60.0) != 0) throw std::runtime_error("xdotool: " + contentOf(scratch_.file("tool")));
}

void sleepFor(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace springtower

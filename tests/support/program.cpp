#include "tests/support/program.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace springtower {
namespace {

// Only calls that are safe between fork and exec.
[[noreturn]] void become(const std::string& program, char* const* arguments, const std::string& in, const std::string& out,
                         const std::string& error) {
  const int input = open(in.c_str(), O_RDONLY);
  const int output = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int errors = open(error.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (input >= 0 && output >= 0 && errors >= 0 && dup2(input, 0) == 0 && dup2(output, 1) == 1 && dup2(errors, 2) == 2) {
    execv(program.c_str(), arguments);
  }
  _exit(127);
}

}  // namespace

ProgramResult runProgram(std::string_view name, const std::vector<std::string>& arguments, std::string_view input,
                         const std::string& output) {
  const std::string program = std::string(SPRINGTOWER_BINARY_DIR) + "/bin/" + std::string(name);
  if (access(program.c_str(), X_OK) != 0) throw std::runtime_error("not built: " + program);
  const ScratchFolder scratch;
  const std::string in = scratch.file("in");
  const std::string out = output.empty() ? scratch.file("out") : output;
  const std::string error = scratch.file("error");
  std::ofstream(in, std::ios::binary) << input;
  std::vector<std::string> words = {std::string(name)};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) become(program, pointers.data(), in, out, error);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
  }
  ProgramResult result;
  result.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  if (output.empty()) result.output = contentOf(out);
  result.error = contentOf(error);
  if (result.exitCode == 127) throw std::runtime_error("cannot run " + program);
  return result;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "springtower-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(std::string("mkdtemp: ") + std::strerror(errno));
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace springtower

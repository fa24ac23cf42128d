#include "tests/random/children.h"

#include "apps/common/json_values.h"
#include "core/processor_time.h"
#include "tests/random/scene_text.h"
#include "tests/support/program.h"
#include "tests/support/sanitizer.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <list>
#include <new>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace springtower {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr double kOverLimit_s = 1.0;  // what a run may take over its limit before its process is ended
constexpr rlim_t kMostAddresses = rlim_t{4} << 30U;
constexpr int kOutOfMemory = 4;
constexpr int kFailed = 5;
// A process that waits uses no processor time: it is ended when this many times its limit have passed.
constexpr double kMostWallTimes = 60.0;

struct Child {
  ChildTask task;
  pid_t process;
  int pipe;
  std::string output;
  Clock::time_point start;
  bool late = false;
};

void limitProcessor(double more_s) {
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  limit.rlim_cur = static_cast<rlim_t>(std::ceil(processorTime_s() + more_s + kOverLimit_s));
  setrlimit(RLIMIT_CPU, &limit);
}

void limitAddresses() {
#if !defined(SPRINGTOWER_ADDRESS_SANITIZER)
  const rlimit limit{kMostAddresses, kMostAddresses};
  setrlimit(RLIMIT_AS, &limit);
#endif
  const rlimit noCore{0, 0};
  setrlimit(RLIMIT_CORE, &noCore);
}

void writeAll(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written < 0 && errno != EINTR) return;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

// Exit code and last state of the program on the scene as a file. A run that is as long has the same end; one with moves also
// ends where the tower falls.
void compareWithProgram(const RandomScene& random, Record& record) {
  if (record.cut || !record.notFinite.empty() || !record.refused.empty()) return;
  const ScratchFolder folder;
  const std::string file = folder.file("scene.toml");
  const std::string report = folder.file("report.json");
  std::ofstream(file) << sceneText(random, random.scene.name);
  const ProgramResult result = runProgram("springtower", {"run", file, "--threads", "1", "--report", report});
  const std::string& failure = record.diverged.empty() ? record.stepLimit : record.diverged;
  const int wanted = failure.empty() ? 0 : 3;
  record.programAgrees = result.exitCode == wanted;
  if (result.exitCode != wanted) {
    record.programSays = fmt::format("exit code {} instead of {}: {}", result.exitCode, wanted, result.error);
  } else if (wanted == 3) {
    record.programAgrees = result.error.find(failure) != std::string::npos;
    if (!*record.programAgrees) record.programSays = "another message: " + result.error;
  } else {
    const Json json = Json::parse(contentOf(report));
    if (json.at("frames").get<long>() != record.frames) {
      record.programAgrees = !random.scene.moves.empty();
      if (!*record.programAgrees) record.programSays = "another number of frames";
    } else if (json.at("state_hash") != record.hash) {
      record.programAgrees = false;
      record.programSays = "another state at the end";
    }
  }
}

// What a child does. Writes the record after every run as a line: the last one counts.
[[noreturn]] void beChild(const ChildTask& task, const ChildOptions& options, int out) {
  const auto line = [&](const Record& record) { writeAll(out, jsonText(recordJson(record)) + "\n"); };
  setpgid(0, 0);  // with the program it runs: both are ended together
  try {
    limitAddresses();
    JudgeOptions judge = options.judge;
    judge.beforeRun = limitProcessor;
    judge.afterRun = line;
    Record record = judgeScene(task.random.scene, judge);
    if (options.withProgram) {
      limitProcessor(2.0 * options.judge.limit_s);
      compareWithProgram(task.random, record);
      line(record);
    }
  } catch (const std::bad_alloc&) {
    _exit(kOutOfMemory);
  } catch (const std::exception& error) {
    writeAll(STDERR_FILENO, fmt::format("{}: {}\n", task.random.scene.name, error.what()));
    _exit(kFailed);
  }
  _exit(0);
}

Child startChild(ChildTask task, const ChildOptions& options) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (process == 0) {
    close(ends[0]);
    beChild(task, options, ends[1]);
  }
  setpgid(process, process);  // here as well: either may come first
  close(ends[1]);
  return {std::move(task), process, ends[0], {}, Clock::now()};
}

std::string endOf(int status, bool late) {
  if (late || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))) return "limit";
  if (WIFSIGNALED(status)) return fmt::format("signal {}", WTERMSIG(status));
  if (WEXITSTATUS(status) == 0) return {};
  return WEXITSTATUS(status) == kOutOfMemory ? "out of memory" : fmt::format("exit code {}", WEXITSTATUS(status));
}

// The record of a child that has closed its pipe.
Record finish(Child& child) {
  close(child.pipe);
  int status = 0;
  while (waitpid(child.process, &status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
  }
  Record record;
  const std::size_t end = child.output.rfind('\n');
  if (end != std::string::npos) {
    const std::size_t before = end == 0 ? std::string::npos : child.output.rfind('\n', end - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    record = recordFromJson(Json::parse(child.output.substr(begin, end - begin)));
  } else {
    const Scene& scene = child.task.random.scene;
    record.scene = scene.name;
    record.method = nameOf(scene.settings.method);
    record.blocks = scene.blocks.size();
    record.massRatio = massRatioOf(scene);
    record.leastSide_m = blockHeightOf(scene);
  }
  record.kind = nameOf(child.task.random.kind);
  record.seed = child.task.seed;
  record.ended = endOf(status, child.late);
  return record;
}

// Waits until a child says something or is late. Reads what they say; true for those that have closed their pipe.
std::vector<bool> listen(std::list<Child>& children, double mostWall_s) {
  std::vector<pollfd> files;
  for (const Child& child : children) files.push_back({child.pipe, POLLIN, 0});
  poll(files.data(), files.size(), 200);
  std::vector<bool> closed(children.size(), false);
  std::size_t i = 0;
  for (Child& child : children) {
    if (files[i].revents != 0) {
      std::array<char, 65536> part{};
      const ssize_t got = read(child.pipe, part.data(), part.size());
      if (got > 0) child.output.append(part.data(), static_cast<std::size_t>(got));
      closed[i] = got == 0 || (got < 0 && errno != EINTR);
    }
    const double wall_s = std::chrono::duration<double>(Clock::now() - child.start).count();
    if (!closed[i] && wall_s > mostWall_s && !child.late) {
      child.late = true;
      kill(-child.process, SIGKILL);
    }
    ++i;
  }
  return closed;
}

}  // namespace

void judgeInChildren(const ChildOptions& options, std::size_t jobs, const std::function<std::optional<ChildTask>()>& next,
                     const std::function<void(const ChildTask&, const Record&)>& done) {
  std::list<Child> children;
  bool more = true;
  while (more || !children.empty()) {
    while (more && children.size() < jobs) {
      std::optional<ChildTask> task = next();
      more = task.has_value();
      if (task) children.push_back(startChild(std::move(*task), options));
    }
    if (children.empty()) break;
    const std::vector<bool> closed = listen(children, kMostWallTimes * (options.judge.limit_s + kOverLimit_s));
    auto child = children.begin();
    for (const bool isClosed : closed) {
      if (!isClosed) {
        ++child;
        continue;
      }
      const Record record = finish(*child);
      done(child->task, record);
      child = children.erase(child);
    }
  }
}

Record judgeInChild(const RandomScene& random, const ChildOptions& options) {
  Record record;
  bool given = false;
  judgeInChildren(
      options, 1,
      [&]() -> std::optional<ChildTask> {
        if (std::exchange(given, true)) return std::nullopt;
        return ChildTask{random, std::nullopt};
      },
      [&](const ChildTask&, const Record& found) { record = found; });
  return record;
}

}  // namespace springtower

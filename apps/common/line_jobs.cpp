#include "apps/common/line_jobs.h"

#include "apps/common/interruption.h"
#include "apps/common/line_reader.h"
#include "apps/common/program.h"
#include "apps/common/progress.h"
#include "core/error.h"

#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>
#include <optional>

namespace springtower {
namespace {

// The list under way. Its own lock guards reading and parsing, and another one what is done.
class LineWork {
 public:
  LineWork(LineReader& input, bool keepGoing, const LineParser& parse) : input_(input), keepGoing_(keepGoing), parse_(parse) {}

  // Takes lines and does them until there are none left.
  void help() {
    while (const std::optional<Task> task = take()) {
      std::string text;
      try {
        // Isolated, so that a thread waiting inside one scene does not start another on top of it.
        tbb::this_task_arena::isolate([&] { text = task->job(); });
      } catch (const InputError&) {
        refuse(task->place);
        continue;
      } catch (const Interrupted&) {
        const std::scoped_lock lock(takeMutex_);
        stopped_ = counts_.interrupted = true;
        return;
      }
      const std::scoped_lock lock(doneMutex_);
      done_[task->place] = std::move(text);
      print();
    }
  }

  LineCounts finish() {
    if (complaint_) std::rethrow_exception(complaint_);
    return counts_;
  }

 private:
  struct Task {
    std::size_t place;  // among the lines that are no blank ones, from 0
    LineJob job;
  };

  std::optional<Task> take() {
    const std::scoped_lock lock(takeMutex_);
    std::string text;
    while (!stopped_) {
      if (interrupted()) counts_.interrupted = true;
      if (counts_.interrupted || !input_.next(text)) {
        counts_.interrupted = counts_.interrupted || interrupted();
        stopped_ = true;
        break;
      }
      ++number_;
      const std::size_t place = counts_.lines;
      try {
        LineJob job = parse_(text, number_, fmt::format("{}: line {}", input_.source(), number_));
        if (!job) continue;
        ++counts_.lines;
        return Task{place, std::move(job)};
      } catch (const InputError&) {
        ++counts_.lines;
        refuseLocked(place);
      }
    }
    return std::nullopt;
  }

  void refuse(std::size_t place) {
    const std::scoped_lock lock(takeMutex_);
    refuseLocked(place);
  }

  // Called in the handler of an InputError. Of several bad lines the first one is what ends the work; those before it are done.
  void refuseLocked(std::size_t place) {
    ++counts_.bad;
    if (keepGoing_) {
      try {
        throw;
      } catch (const InputError& error) {
        complain("springtower", error.what());
      }
      const std::scoped_lock lock(doneMutex_);
      done_[place].clear();
      print();
      return;
    }
    stopped_ = true;
    if (complaint_ && place > complaintAt_) return;
    complaint_ = std::current_exception();
    complaintAt_ = place;
  }

  // Under the lock of what is done: all texts up to the first that is missing.
  void print() {
    for (auto first = done_.begin(); first != done_.end() && first->first == printed_; first = done_.erase(first), ++printed_) {
      progress_.clear();
      std::fwrite(first->second.data(), 1, first->second.size(), stdout);
    }
    if (std::fflush(stdout) != 0) throw InputError("standard output: writing failed");
    progress_.update(static_cast<double>(printed_));
  }

  LineReader& input_;
  bool keepGoing_;
  const LineParser& parse_;
  std::mutex takeMutex_;
  std::size_t number_ = 0;
  bool stopped_ = false;
  LineCounts counts_;
  std::exception_ptr complaint_;
  std::size_t complaintAt_ = 0;
  std::mutex doneMutex_;
  std::map<std::size_t, std::string> done_;  // by place, not printed yet
  std::size_t printed_ = 0;
  Progress progress_{0.0, "lines"};
};

}  // namespace

LineCounts workOffLines(LineReader& input, int threads, bool keepGoing, const LineParser& parse) {
  LineWork work(input, keepGoing, parse);
  tbb::parallel_for(
      0, threads, [&](int) { work.help(); }, tbb::simple_partitioner());
  return work.finish();
}

int exitCodeOf(const LineCounts& counts, int otherwise) {
  if (counts.bad > 0) {
    complain("springtower",
             fmt::format("{} of {} lines {} bad and left out", counts.bad, counts.lines, counts.bad == 1 ? "was" : "were"));
  }
  if (counts.interrupted) return interruptionExitCode();
  return counts.bad > 0 ? kBadInput : otherwise;
}

}  // namespace springtower

#include "apps/common/line_jobs.h"

#include "apps/common/interruption.h"
#include "apps/common/line_reader.h"
#include "apps/common/program.h"
#include "apps/common/progress.h"
#include "core/error.h"

#include <atomic>
#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_arena.h>
#include <optional>
#include <utility>

namespace springtower {
namespace {

// The list under way. One lock guards reading and parsing, held while the input is waited for, and another one what came of the
// lines, so that a line is printed or reported meanwhile.
class LineWork {
 public:
  LineWork(LineReader& input, bool keepGoing, const LineParser& parse) : input_(input), keepGoing_(keepGoing), parse_(parse) {}

  // Takes lines and does them until there are none left. What is thrown here ends the whole list.
  void help() {
    try {
      while (const std::optional<Task> task = take()) work(*task);
    } catch (...) {
      stopped_ = true;
      throw;
    }
  }

  LineCounts finish() {
    if (complaint_) std::rethrow_exception(complaint_);
    counts_.lines = lines_;
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
      try {
        if (interrupted() || !input_.next(text, [&] { return stopped_.load(); })) {
          if (interrupted()) noteInterrupted();
          stopped_ = true;
          break;
        }
      } catch (const LongLineError&) {
        ++number_;
        refuse(lines_++);
        continue;
      }
      ++number_;
      const std::size_t place = lines_;
      try {
        LineJob job = parse_(text, number_, fmt::format("{}: line {}", input_.source(), number_));
        if (!job) continue;
        ++lines_;
        return Task{place, std::move(job)};
      } catch (const InputError&) {
        ++lines_;
        refuse(place);
      }
    }
    return std::nullopt;
  }

  void work(const Task& task) {
    std::string text;
    try {
      // Isolated, so that a thread waiting inside one scene does not start another on top of it.
      tbb::this_task_arena::isolate([&] { text = task.job(); });
    } catch (const InputError&) {
      refuse(task.place);
      return;
    } catch (const Interrupted&) {
      noteInterrupted();
      stopped_ = true;
      return;
    }
    const std::scoped_lock lock(doneMutex_);
    done_[task.place] = std::move(text);
    print();
  }

  void noteInterrupted() {
    const std::scoped_lock lock(doneMutex_);
    counts_.interrupted = true;
  }

  // Called in the handler of an InputError. Of several bad lines the first one is what ends the work; those before it are done.
  void refuse(std::size_t place) {
    const std::scoped_lock lock(doneMutex_);
    ++counts_.bad;
    if (keepGoing_) {
      try {
        throw;
      } catch (const InputError& error) {
        complain("springtower", error.what());
      }
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
  std::size_t lines_ = 0;             // that are no blank ones
  std::atomic<bool> stopped_{false};  // no more lines are taken
  std::mutex doneMutex_;              // may be locked while the other one is held, not the other way round
  LineCounts counts_;                 // but the lines
  std::exception_ptr complaint_;
  std::size_t complaintAt_ = 0;
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

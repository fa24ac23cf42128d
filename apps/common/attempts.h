#pragma once

#include <exception>

namespace springtower {

/// Actions that do not stop one another: outputs, of which one that cannot be written is to cost none of the others.
class Attempts {
 public:
  /// Runs an action; keeps the first exception that any has thrown.
  template <class Action>
  void attempt(const Action& action) {
    try {
      action();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
  }
  /// Whether any has thrown.
  [[nodiscard]] bool failed() const { return failure_ != nullptr; }
  /// Throws that exception.
  void finish() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
};

}  // namespace springtower

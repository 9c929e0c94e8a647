#pragma once

#include <exception>
#include <stop_token>

namespace kinship {

/// Ends a computation that nobody waits for any more. No failure: nothing went wrong, and nothing
/// is to be kept of it.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped"; }
};

/// To be called about every 10 ms of work. \throws Stopped if that was asked for.
inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested())
    throw Stopped();
}

}  // namespace kinship

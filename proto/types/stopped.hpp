#pragma once

#include <exception>
#include <stop_token>

namespace kinship {

/// Ends a computation that is no longer needed. Not a failure; partial results are discarded.
class Stopped : public std::exception {
 public:
  const char* what() const noexcept override { return "stopped"; }
};

/// Call it about every 10 ms of work. \throws Stopped if a stop was requested.
inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested())
    throw Stopped();
}

}  // namespace kinship

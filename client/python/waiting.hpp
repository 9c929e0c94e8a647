#pragma once

#include <chrono>
#include <functional>

namespace kinship::python {

/// Longest delay of a signal during a wait for a call on another thread.
inline constexpr std::chrono::milliseconds kSignalInterval{50};

/// Lets Python handle signals. With the interpreter's lock.
/// \throws the handler's exception: KeyboardInterrupt.
void hear_signals();

/// Waits without the interpreter's lock and handles signals meanwhile. Called with the lock.
/// \param wait  waits at most that long. \return whether the wait is over.
/// \throws as hear_signals().
void wait_until(const std::function<bool(std::chrono::milliseconds)>& wait);

}  // namespace kinship::python

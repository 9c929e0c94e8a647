#pragma once

#include <chrono>
#include <functional>

namespace kinship::python {

/// So long a signal may have to wait until Python hears of it, of calls that are waited for by
/// another thread.
inline constexpr std::chrono::milliseconds kSignalInterval{50};

/// Lets Python handle signals. With the interpreter's lock.
/// \throws what the handler raises: KeyboardInterrupt.
void hear_signals();

/// Waits without the interpreter's lock and hears signals meanwhile. Called with the lock.
/// \param wait  waits so long at most. \return whether what is waited for is there.
/// \throws as hear_signals().
void wait_until(const std::function<bool(std::chrono::milliseconds)>& wait);

}  // namespace kinship::python

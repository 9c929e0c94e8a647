#include "server/app/service_manager.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

namespace kinship::app {
namespace {

/// A whole number above zero in the environment; none if it is missing or something else.
std::optional<std::int64_t> number_of(const char* name) {
  const char* const text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): none is set
  if (text == nullptr)
    return std::nullopt;
  std::int64_t number = 0;
  const char* const end = text + std::strlen(text);
  const auto [last, error] = std::from_chars(text, end, number);
  if (error != std::errc() || last != end || number <= 0)
    return std::nullopt;
  return number;
}

}  // namespace

bool notify_service_manager(std::string_view state) {
  const char* variable = std::getenv("NOTIFY_SOCKET");  // NOLINT(concurrency-mt-unsafe)
  std::string path = variable == nullptr ? "" : variable;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || (path[0] != '/' && path[0] != '@') || path.size() >= sizeof address.sun_path)
    return false;
  if (path[0] == '@')
    path[0] = '\0';  // a name in Linux's abstract namespace
  std::memcpy(static_cast<void*>(address.sun_path), path.data(), path.size());
  const int handle = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (handle < 0)
    return false;
  const ssize_t sent = sendto(
      handle, state.data(), state.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address),
      static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size()));
  close(handle);
  return sent == static_cast<ssize_t>(state.size());
}

Watchdog::Watchdog() {
  const auto timeout_us = number_of("WATCHDOG_USEC");
  const auto process = number_of("WATCHDOG_PID");
  if (timeout_us && (!process || *process == getpid()))
    interval_ = std::chrono::microseconds(std::max<std::int64_t>(*timeout_us / 2, 1));
}

Watchdog::TimePoint Watchdog::beat(TimePoint now) {
  if (!interval_)
    return TimePoint::max();
  if (now >= next_) {
    notify_service_manager("WATCHDOG=1");
    next_ = now + *interval_;
  }
  return next_;
}

}  // namespace kinship::app

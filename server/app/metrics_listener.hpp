#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/app/metrics_address.hpp"

namespace kinship::app {

/// A bound TCP port on which no listener answers yet.
class MetricsPort {
 public:
  /// \throws Failure(Unavailable) if it cannot be bound: taken, not permitted, or not an address of
  ///         this machine.
  explicit MetricsPort(const MetricsAddress& address);
  ~MetricsPort();
  MetricsPort(MetricsPort&& other) noexcept;
  MetricsPort& operator=(MetricsPort&& other) noexcept;

  std::string url() const;  ///< of the page

 private:
  friend class MetricsListener;
  struct State;
  std::unique_ptr<State> state_;
};

/// Limits of the connections to the metrics port.
struct MetricsLimits {
  std::size_t connections = 16;  ///< at a time; one more closes the oldest
  std::size_t header_bytes = 8192;
  std::chrono::milliseconds request_time{5000};  ///< from connection to reply, and for the reply
  /// A page younger than this is sent again, however many requests come.
  std::chrono::milliseconds page_age{200};
  std::vector<std::string> hosts = {};  ///< see is_served_host()
};

/// Answers GET /metrics over HTTP/1, one request a connection, on a thread of its own. A connection
/// can slow down only other connections.
class MetricsListener {
 public:
  /// \param page  called on the thread; if it throws, the reply is 503.
  MetricsListener(MetricsPort port, std::function<std::string()> page, MetricsLimits limits = {});
  ~MetricsListener();  ///< no call after it; open connections are closed
  MetricsListener(const MetricsListener&) = delete;
  MetricsListener& operator=(const MetricsListener&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::app

#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "proto/types/publications.hpp"
#include "server/http/message.hpp"

namespace kinship::console {

/// Sends the server's events, and once a second its status, to all browsers that listen, as
/// server-sent events (https://html.spec.whatwg.org/multipage/server-sent-events.html). Events are
/// gathered for a quarter of a second, so that a busy server costs as little as a quiet one. May
/// be shared between threads.
class Broadcast {
 public:
  static constexpr std::size_t kMaxListeners = 64;
  static constexpr std::size_t kMaxGathered = 500;  ///< events; more are left out, and counted

  Broadcast() = default;
  ~Broadcast() { stop(); }
  Broadcast(const Broadcast&) = delete;
  Broadcast& operator=(const Broadcast&) = delete;

  /// Does nothing while nobody listens; never waits.
  void publish(const Event& event);

  /// \return false if there are kMaxListeners.
  bool add(http::Send listener);
  std::size_t listeners() const noexcept { return count_.load(); }

  /// Begins to send, on a thread of its own.
  /// \param status  a JSON document; called on that thread, once a second while somebody listens.
  void start(std::function<std::string()> status);
  void stop();  ///< the status is not called after it

 private:
  void run(const std::function<std::string()>& status);
  void send(std::string text);
  std::string take_events();

  std::mutex mutex_;  // guards what follows, but for the thread
  std::condition_variable changed_;
  std::vector<http::Send> listeners_;
  std::vector<Event> gathered_;
  std::uint64_t left_out_ = 0;
  bool has_new_ = false;  // a listener that has heard no status
  bool is_stopping_ = false;
  std::atomic<std::size_t> count_ = 0;  // of the listeners
  std::thread thread_;
};

}  // namespace kinship::console

#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "client/link/client.hpp"
#include "proto/types/publications.hpp"

namespace kinship::python {

/// A queue of the server's events; beyond kMaxEvents it drops the oldest. Shared by threads.
class EventStream {
 public:
  static constexpr std::size_t kMaxEvents = 10'000;

  explicit EventStream(const link::Client& client);

  /// Takes the oldest event; waits for one at most `longest`. Missing: none arrived, or closed.
  std::optional<Event> take(std::chrono::milliseconds longest);

  bool is_closed() const;
  std::size_t dropped() const;

  /// Ends every take() and receives no more events.
  void close();

 private:
  void add(const Event& event);

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable changed_;
  std::deque<Event> events_;
  std::size_t dropped_ = 0;
  bool is_closed_ = false;
  std::unique_ptr<link::Watcher> watcher_;  // last: no handler runs when the others end
};

}  // namespace kinship::python

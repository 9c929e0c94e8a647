#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "proto/types/publications.hpp"
#include "server/runtime/clock.hpp"

namespace kinship::service {

/// Sends events to people who watch, at most `per_second` of them: the rest is counted, and the
/// next event carries the number left out. May be shared between threads.
class EventFeed {
 public:
  /// Called from any thread, without a lock; must not throw or block.
  using Sink = std::function<void(const Event&)>;

  /// \param clock  outlives the feed.
  /// \param sink   empty: no events are sent.
  EventFeed(const runtime::Clock& clock, Sink sink, std::size_t per_second = 1000)
      : clock_(clock), sink_(std::move(sink)), per_second_(per_second) {}
  EventFeed(const EventFeed&) = delete;
  EventFeed& operator=(const EventFeed&) = delete;

  /// \param text   makes the line; called only if the event is sent. The line is cut to
  ///               kMaxEventBytes.
  /// \param robot  label or short digest; may be empty, as may the task.
  template <typename Text>
  void tell(EventKind kind, std::string_view task, std::string_view robot, const Text& text) {
    if (sink_ && may_tell())
      send(kind, task, robot, text());
  }

  std::uint64_t dropped() const;  ///< since construction

 private:
  bool may_tell();
  void send(EventKind kind, std::string_view task, std::string_view robot, std::string_view text);

  const runtime::Clock& clock_;
  const Sink sink_;
  const std::size_t per_second_;

  mutable std::mutex mutex_;  // guards what follows
  std::chrono::steady_clock::time_point second_began_{};
  std::size_t told_ = 0;       // in this second
  std::uint64_t dropped_ = 0;  // since construction
  std::uint64_t unsaid_ = 0;   // of these, not yet reported by an event
};

}  // namespace kinship::service

#include "server/service/event_feed.hpp"

#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::service {

bool EventFeed::may_tell() {
  constexpr std::chrono::seconds kSecond(1);
  const auto now = clock_.now();
  const std::lock_guard lock(mutex_);
  if (told_ == 0 || now - second_began_ >= kSecond) {
    second_began_ = now;
    told_ = 0;
  }
  if (told_ < per_second_) {
    ++told_;
    return true;
  }
  ++dropped_;
  ++unsaid_;
  return false;
}

void EventFeed::send(EventKind kind, std::string_view task, std::string_view robot,
                     std::string_view text) {
  std::uint64_t unsaid = 0;
  {
    const std::lock_guard lock(mutex_);
    unsaid = std::exchange(unsaid_, 0);
  }
  Event event;
  event.time_ms = clock_.unix_ms();
  if (unsaid > 0) {
    event.kind = EventKind::Administration;
    event.text = std::to_string(unsaid) + " events were not told, at most " +
                 std::to_string(per_second_) + " a second are";
    sink_(event);
  }
  event.kind = kind;
  event.task = task;
  event.robot = robot;
  event.text = cut_text(text, kMaxEventBytes);
  sink_(event);
}

std::uint64_t EventFeed::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace kinship::service

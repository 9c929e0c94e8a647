#include "client/python/event_stream.hpp"

#include <utility>

namespace kinship::python {

EventStream::EventStream(const link::Client& client)
    : watcher_(client.watch({.on_event = [this](const Event& event) { add(event); }})) {}

void EventStream::add(const Event& event) {
  {
    const std::scoped_lock lock(mutex_);
    if (events_.size() == kMaxEvents) {
      events_.pop_front();
      ++dropped_;
    }
    events_.push_back(event);
  }
  changed_.notify_one();
}

std::optional<Event> EventStream::take(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, longest, [this] { return is_closed_ || !events_.empty(); });
  if (is_closed_ || events_.empty())
    return std::nullopt;
  Event event = std::move(events_.front());
  events_.pop_front();
  return event;
}

bool EventStream::is_closed() const {
  const std::scoped_lock lock(mutex_);
  return is_closed_;
}

std::size_t EventStream::dropped() const {
  const std::scoped_lock lock(mutex_);
  return dropped_;
}

void EventStream::close() {
  std::unique_ptr<link::Watcher> ended;  // without the lock, for which its handler may wait
  {
    const std::scoped_lock lock(mutex_);
    is_closed_ = true;
    events_.clear();
    ended = std::move(watcher_);
  }
  changed_.notify_all();
}

}  // namespace kinship::python

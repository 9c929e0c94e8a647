#include "server/console/broadcast.hpp"

#include <utility>

#include "proto/json/event_json.hpp"

namespace kinship::console {
namespace {

constexpr std::chrono::milliseconds kGather{250};
constexpr int kGathersOfStatus = 4;  // a second

std::string message(const char* name, const std::string& data) {
  return std::string("event: ") + name + "\ndata: " + data + "\n\n";
}

}  // namespace

void Broadcast::publish(const Event& event) {
  if (count_ == 0)
    return;
  const std::lock_guard lock(mutex_);
  if (gathered_.size() < kMaxGathered)
    gathered_.push_back(event);
  else
    ++left_out_;
}

bool Broadcast::add(http::Send listener) {
  const std::lock_guard lock(mutex_);
  if (count_ >= kMaxListeners)  // some of them may be sent to just now
    return false;
  listeners_.push_back(std::move(listener));
  ++count_;
  has_new_ = true;
  changed_.notify_all();
  return true;
}

void Broadcast::start(std::function<std::string()> status) {
  thread_ = std::thread([this, status = std::move(status)] { run(status); });
}

void Broadcast::stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  if (thread_.joinable())
    thread_.join();
}

void Broadcast::run(const std::function<std::string()>& status) {
  std::unique_lock lock(mutex_);
  for (int gathers = 0; !is_stopping_;) {
    changed_.wait(lock, [&] { return is_stopping_ || !listeners_.empty(); });
    if (is_stopping_)
      return;
    const bool is_time = std::exchange(has_new_, false) || gathers % kGathersOfStatus == 0;
    ++gathers;
    lock.unlock();
    std::string text = take_events();
    if (is_time)
      text += message("status", status());
    if (!text.empty())
      send(std::move(text));
    lock.lock();
    changed_.wait_for(lock, kGather, [&] { return is_stopping_; });
  }
}

std::string Broadcast::take_events() {
  std::vector<Event> events;
  std::uint64_t left_out = 0;
  {
    const std::lock_guard lock(mutex_);
    events.swap(gathered_);
    std::swap(left_out, left_out_);
  }
  std::string text;
  for (const Event& event : events)
    text += message("event", json::to_json(event));
  if (left_out > 0)
    text += message("left_out", std::to_string(left_out));
  return text;
}

/// Outside the lock: an event must not wait for it.
void Broadcast::send(std::string text) {
  std::vector<http::Send> listeners;
  {
    const std::lock_guard lock(mutex_);
    listeners.swap(listeners_);
  }
  const auto part = std::make_shared<const std::string>(std::move(text));
  std::erase_if(listeners, [&](const http::Send& each) { return !each(part); });
  const std::lock_guard lock(mutex_);
  listeners_.insert(listeners_.begin(), std::make_move_iterator(listeners.begin()),
                    std::make_move_iterator(listeners.end()));
  count_ = listeners_.size();
}

}  // namespace kinship::console

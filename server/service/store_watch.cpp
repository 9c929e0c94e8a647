#include "server/service/store_watch.hpp"

#include <exception>
#include <optional>
#include <utility>

namespace kinship::service {

StoreWatch::StoreWatch(const store::Store& store,
                       std::function<void(const store::StoreChanges&)> changed)
    : store_(store), changed_(std::move(changed)) {
  const std::optional<store::StoreChanges> now = store_.changes_since("");
  if (!now)
    return;
  cursor_ = now->cursor;  // no memory holds anything yet
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void StoreWatch::stop() {
  if (!thread_.joinable())
    return;
  thread_.request_stop();
  thread_.join();
}

void StoreWatch::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      look();
    } catch (const std::exception&) {  // status() says why; the next look finds the changes
    }
    std::unique_lock lock(mutex_);
    stopping_.wait_for(lock, stop, kInterval, [] { return false; });
  }
}

void StoreWatch::look() {
  const std::optional<store::StoreChanges> changes = store_.changes_since(cursor_);
  if (!changes)
    return;
  changed_(*changes);
  cursor_ = changes->cursor;
}

}  // namespace kinship::service

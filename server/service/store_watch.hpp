#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "server/store/store.hpp"

namespace kinship::service {

/// Notifies of changes in a store that has several servers, on a thread of its own. Where one
/// server has the store to itself there is no thread. A store that cannot be read is read again: a
/// cursor marks the changes already notified, so none is left out.
class StoreWatch {
 public:
  /// Longest time for which a change of another server goes unnoticed.
  static constexpr std::chrono::milliseconds kInterval{250};

  /// \param store    outlives the watch.
  /// \param changed  called on the watch's thread with the new changes; may throw for a store that
  ///                 cannot be read, and is then called with the same changes again.
  StoreWatch(const store::Store& store, std::function<void(const store::StoreChanges&)> changed);
  ~StoreWatch() { stop(); }
  StoreWatch(const StoreWatch&) = delete;
  StoreWatch& operator=(const StoreWatch&) = delete;

  /// Ends the thread. A second call returns at once.
  void stop();

 private:
  void run(const std::stop_token& stop);
  void look();

  const store::Store& store_;
  const std::function<void(const store::StoreChanges&)> changed_;
  std::string cursor_;  // of the thread, once it runs
  std::mutex mutex_;
  std::condition_variable_any stopping_;
  std::jthread thread_;  // last: uses all of the above
};

}  // namespace kinship::service

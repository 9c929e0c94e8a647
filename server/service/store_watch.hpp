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

/// Tells what anybody changed in a store that has several servers, on a thread of its own. Where
/// one server has the store to itself there is no thread. A store that cannot be asked is asked
/// again: nothing is left out then, for what has been told is known by a cursor.
class StoreWatch {
 public:
  /// How long what another server did may go unnoticed.
  static constexpr std::chrono::milliseconds kInterval{250};

  /// \param store    outlives the watch.
  /// \param changed  called on the watch's thread with what is new; may throw for a store that
  ///                 cannot be read, and is then called with the same once more.
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

#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

#include "server/runtime/clock.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// Reads the status of a store on a thread of its own: a caller does not wait long for a store that
/// does not answer, e.g. behind a network or on a disk that hangs, and gets its last status. May be
/// shared between threads.
class StoreStatusReader {
 public:
  /// \param store     outlives the reader; it is read once at the beginning.
  /// \param patience  longest time of a read.
  StoreStatusReader(const store::Store& store, runtime::Clock clock,
                    std::chrono::milliseconds patience);
  ~StoreStatusReader() { stop(); }
  StoreStatusReader(const StoreStatusReader&) = delete;
  StoreStatusReader& operator=(const StoreStatusReader&) = delete;

  /// The current status; or the last one, not writable, with a message, if the store does not
  /// answer. One call at a time waits for that, others return at once. Waits for a store that has
  /// never answered. \throws the store's exceptions.
  store::StoreStatus read();

  /// Ends the thread, after the store's pending answer. Later calls of read() ask the store
  /// themselves.
  void stop();

 private:
  void run();
  store::StoreStatus of_before() const;

  const store::Store& store_;
  const runtime::Clock clock_;
  const std::chrono::milliseconds patience_;
  std::mutex mutex_;  // guards what follows, but for the thread
  std::condition_variable asked_for_, answered_for_;
  std::uint64_t asked_ = 1;     // reads so far; the first one is ours
  std::uint64_t answered_ = 0;  // of them
  bool is_silent_ = false;      // a call has waited in vain for the store's pending answer
  bool is_stopping_ = false;
  std::optional<store::StoreStatus> last_;
  std::chrono::steady_clock::time_point last_at_{};
  std::exception_ptr failure_;  // of the last answer
  std::thread thread_;          // last: uses all of the above
};

}  // namespace kinship::service

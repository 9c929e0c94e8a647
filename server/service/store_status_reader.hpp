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

/// What a store says of itself. It is asked on a thread of its own: nobody waits for long for a
/// store that does not answer, as one behind a network or on a disk that hangs, and is told what it
/// said last. May be shared between threads.
class StoreStatusReader {
 public:
  /// \param store     outlives the reader; it is asked once at the beginning.
  /// \param patience  how long a question may take.
  StoreStatusReader(const store::Store& store, runtime::Clock clock,
                    std::chrono::milliseconds patience);
  ~StoreStatusReader() { stop(); }
  StoreStatusReader(const StoreStatusReader&) = delete;
  StoreStatusReader& operator=(const StoreStatusReader&) = delete;

  /// As it is now; or as it was, not writable, with a message, if the store does not answer. One
  /// question at a time waits for that, the others are answered at once. A store that has never
  /// answered is waited for. \throws what the store throws.
  store::StoreStatus read();

  /// Ends the thread, after what the store is answering. From then on whoever reads asks the store.
  void stop();

 private:
  void run();
  store::StoreStatus of_before() const;

  const store::Store& store_;
  const runtime::Clock clock_;
  const std::chrono::milliseconds patience_;
  std::mutex mutex_;  // guards what follows, but for the thread
  std::condition_variable asked_for_, answered_for_;
  std::uint64_t asked_ = 1;     // questions so far; the first one is ours
  std::uint64_t answered_ = 0;  // of them
  bool is_silent_ = false;      // somebody has waited in vain for what the store is answering
  bool is_stopping_ = false;
  std::optional<store::StoreStatus> last_;
  std::chrono::steady_clock::time_point last_at_{};
  std::exception_ptr failure_;  // of the last answer
  std::thread thread_;          // last: uses all of the above
};

}  // namespace kinship::service

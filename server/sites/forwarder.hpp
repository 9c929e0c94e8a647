#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "proto/types/summaries.hpp"
#include "server/sites/backoff.hpp"
#include "server/sites/exchange.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

struct ForwarderOptions {
  /// Connects to the memory above. Called on the forwarder's thread, again after each lost
  /// connection. \throws Failure
  std::function<std::unique_ptr<store::Store>()> open;
  std::string name;  ///< of the memory, for people; without passwords
  ExchangeOptions exchange;
  SiteHooks hooks;
  int niceness = 10;
  /// Number of reports that wait at this site; they take precedence.
  std::function<std::size_t()> queued_reports = [] { return std::size_t{0}; };
  /// Called when the connection is made, or lost with the reason. On the forwarder's thread.
  std::function<void(std::string_view)> on_line = [](std::string_view) {};
  std::chrono::milliseconds first_retry{1000};
  std::chrono::milliseconds longest_retry{60'000};
  /// Ratio of rest to load on this machine: 3 is a quarter of one processor at most.
  double rest = 3;
  std::uint64_t seed = std::random_device()();
};

/// Synchronises a site's store with the memory above it, on a thread of its own: connects,
/// reconnects after a lost connection, and exchanges new data. The site never waits for it.
class Forwarder {
 public:
  /// \param site  outlives it.
  Forwarder(store::Store& site, ForwarderOptions options);
  ~Forwarder();  ///< stop()
  Forwarder(const Forwarder&) = delete;
  Forwarder& operator=(const Forwarder&) = delete;

  /// Call when the site has new data. From any thread; returns at once.
  void wake();

  /// Call when a robot of the site uses a task that none used lately. Otherwise as wake().
  void wake_for_task();

  /// Returns when no data is carried any more. An interrupted piece is carried again at the next
  /// start. A second call returns at once.
  void stop();

  /// \param attempts  in the site's store.
  UpstreamStatus status(std::uint64_t attempts) const;

 private:
  /// While it lives, stop() can end calls that wait for the memory.
  class Connected;
  class Saved;

  void run(const std::stop_token& stop);
  void exchange(const std::stop_token& stop);
  void remember();
  void wait_for_line(const std::stop_token& stop);
  void tell_line(bool is_connected, const std::string& why);
  void publish(const Positions& positions);
  void note_oldest(const Positions& positions);
  void rest(std::chrono::nanoseconds load, const std::stop_token& stop);
  void wait(std::chrono::nanoseconds time, const std::stop_token& stop);

  store::Store& site_;
  const ForwarderOptions options_;
  // The forwarder's thread only:
  ExchangeCounts counts_;
  Backoff backoff_;

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable_any changed_;
  bool is_woken_ = false;
  bool has_new_task_ = false;
  UpstreamStatus status_;
  std::uint64_t passed_ = 0;
  store::Store* memory_ = nullptr;  // while there is a Connected

  std::jthread thread_;  // last: it uses all above
};

}  // namespace kinship::sites

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
  /// Connects with the memory above. Called on the forwarder's thread, as often as the line was
  /// lost. \throws Failure
  std::function<std::unique_ptr<store::Store>()> open;
  std::string name;  ///< of the memory, for people; without passwords
  ExchangeOptions exchange;
  SiteHooks hooks;
  int niceness = 10;
  /// Reports of robots that wait at this site: they come first.
  std::function<std::size_t()> queued_reports = [] { return std::size_t{0}; };
  /// The line came, or went and why. Called on the forwarder's thread.
  std::function<void(std::string_view)> on_line = [](std::string_view) {};
  std::chrono::milliseconds first_retry{1000};
  std::chrono::milliseconds longest_retry{60'000};
  /// How long it rests for what it took of this machine: 3 is a quarter of one processor at most.
  double rest = 3;
  std::uint64_t seed = std::random_device()();
};

/// Keeps a site's store and the memory above it together, on a thread of its own: connects, and
/// again when the line was lost, and exchanges what is new. The site never waits for it.
class Forwarder {
 public:
  /// \param site  outlives it.
  Forwarder(store::Store& site, ForwarderOptions options);
  ~Forwarder();  ///< stop()
  Forwarder(const Forwarder&) = delete;
  Forwarder& operator=(const Forwarder&) = delete;

  /// There is something new at the site. From any thread; returns at once.
  void wake();

  /// A robot of the site uses a task that none used lately. As wake().
  void wake_for_task();

  /// Returns when nothing is carried any more. What was on its way is carried again at the next
  /// start. A second call returns at once.
  void stop();

  /// \param attempts  that the site's store has.
  UpstreamStatus status(std::uint64_t attempts) const;

 private:
  /// While it lives, whoever stops can end what waits for the memory.
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

#pragma once

#include <chrono>
#include <functional>
#include <memory>

#include "proto/dds/participant.hpp"

namespace kinship::dds {

/// Waits on one thread for requests of any number of repliers.
///
/// Handlers of the attached repliers run on the thread that called run(). wake() and stop() may
/// be called from any thread, also from a handler.
class WaitLoop {
 public:
  using Clock = std::chrono::steady_clock;

  explicit WaitLoop(const Participant& participant);
  ~WaitLoop();
  WaitLoop(const WaitLoop&) = delete;
  WaitLoop& operator=(const WaitLoop&) = delete;

  /// Serves until stop().
  /// \param on_wake  called before every wait: does the due work and returns the latest time of its
  ///                 next call (Clock::time_point::max(): when woken).
  void run(const std::function<Clock::time_point()>& on_wake);

  void wake();  ///< has on_wake called soon
  void stop();  ///< run() returns after the handler it is in; also if called before run()

  /// Return values of on_data besides times: call again after the others' turn; call when there are
  /// samples.
  static constexpr Clock::time_point kAgain = Clock::time_point::min();
  static constexpr Clock::time_point kWithSamples = Clock::time_point::max();

  /// For repliers: `on_data` is called on the loop's thread when `reader` has samples, at the time
  /// that it last returned, and when `guard`, a guard condition, is set, if there is one. Call
  /// before run(); both must live as long as the loop runs.
  void attach(const Entity& reader, std::function<Clock::time_point()> on_data,
              const Entity* guard = nullptr);

  /// For repliers and publishers: `on_time` is called on the loop's thread about every `period`.
  /// Call before run().
  void every(Clock::duration period, std::function<void()> on_time);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::dds

#pragma once

#include <functional>
#include <thread>

namespace kinship::app {

/// Keeps SIGTERM, SIGINT and SIGHUP from ending the process until a SignalWatcher takes them. Call
/// it before any other thread is made: threads inherit it.
void hold_termination_signals();

/// Turns held signals, earlier ones too, into calls on a thread of its own, where any code may run.
class SignalWatcher {
 public:
  /// \param on_signal  called for each signal with its number; must not throw.
  /// \throws Failure(Internal) if the operating system refuses.
  explicit SignalWatcher(std::function<void(int)> on_signal);
  ~SignalWatcher();  ///< no call after it; the signals are held again
  SignalWatcher(const SignalWatcher&) = delete;
  SignalWatcher& operator=(const SignalWatcher&) = delete;

 private:
  void watch() const;

  std::function<void(int)> on_signal_;
  int signals_ = -1;  // signalfd
  int end_ = -1;      // eventfd, readable when the watcher ends
  std::thread thread_;
};

}  // namespace kinship::app

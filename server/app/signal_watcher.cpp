#include "server/app/signal_watcher.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::app {

namespace {

sigset_t termination_signals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGHUP);
  return set;
}

}  // namespace

void hold_termination_signals() {
  const sigset_t set = termination_signals();
  if (const int error = pthread_sigmask(SIG_BLOCK, &set, nullptr); error != 0)
    throw Failure(ErrorCode::Internal,
                  "cannot hold signals: " + std::system_category().message(error));
}

SignalWatcher::SignalWatcher(std::function<void(int)> on_signal)
    : on_signal_(std::move(on_signal)) {
  const sigset_t set = termination_signals();
  signals_ = signalfd(-1, &set, SFD_CLOEXEC);
  end_ = eventfd(0, EFD_CLOEXEC);
  if (signals_ < 0 || end_ < 0) {
    const std::string reason = std::system_category().message(errno);
    if (signals_ >= 0)
      close(signals_);
    if (end_ >= 0)
      close(end_);
    throw Failure(ErrorCode::Internal, "cannot watch for signals: " + reason);
  }
  thread_ = std::thread([this] { watch(); });
}

SignalWatcher::~SignalWatcher() {
  eventfd_write(end_, 1);
  thread_.join();
  close(signals_);
  close(end_);
}

void SignalWatcher::watch() const {
  std::array<pollfd, 2> files = {pollfd{signals_, POLLIN, 0}, pollfd{end_, POLLIN, 0}};
  for (;;) {
    if (poll(files.data(), files.size(), -1) < 0 && errno != EINTR)
      return;
    if ((files[1].revents & POLLIN) != 0)
      return;
    signalfd_siginfo information{};
    if ((files[0].revents & POLLIN) != 0 &&
        read(signals_, &information, sizeof information) == ssize_t{sizeof information})
      on_signal_(static_cast<int>(information.ssi_signo));
  }
}

}  // namespace kinship::app

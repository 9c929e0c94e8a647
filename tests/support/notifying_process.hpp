#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kinship::test {

/// A server process that says by itself when it is ready, as services of systemd do (sd_notify).
/// Killed on destruction, with the processes it started.
class NotifyingProcess {
 public:
  /// \param command  a program's path, and its arguments.
  /// \param socket   where it will be told to say so; anybody may write to it.
  /// \param log      gets what it prints, appended.
  NotifyingProcess(const std::vector<std::string>& command, const std::filesystem::path& socket,
                   std::filesystem::path log);
  ~NotifyingProcess();
  NotifyingProcess(const NotifyingProcess&) = delete;
  NotifyingProcess& operator=(const NotifyingProcess&) = delete;

  pid_t pid() const noexcept { return pid_; }
  bool is_running() const noexcept { return is_running_; }

  /// Forgets what it has said until now.
  void forget_readiness() const;
  /// Returns once it says that it is ready. \throws std::runtime_error with its log if it ends
  /// before that, or says nothing for a minute.
  void wait_until_ready();

  void signal(int number) const;
  int wait();  ///< for its end. \return exit code, or 128 + the signal that ended it

  /// Processes it started and that live. \param title  only those with this in their command line.
  std::vector<pid_t> children(std::string_view title = {}) const;
  /// SIGKILL to it and all that it started, at one moment; returns when all are gone.
  void kill_all();

 private:
  void open_socket(const std::filesystem::path& socket);
  void spawn(const std::vector<std::string>& command, const std::filesystem::path& socket);

  std::filesystem::path log_;
  int socket_ = -1;
  pid_t pid_ = -1;
  int status_ = 0;
  bool is_running_ = false;
};

/// Runs a program to its end. \throws std::runtime_error with what it printed unless it ends with
/// 0.
void run_to_end(const std::vector<std::string>& command, const std::filesystem::path& log);

}  // namespace kinship::test

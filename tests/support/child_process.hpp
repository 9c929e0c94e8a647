#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace kinship::test {

/// A child process whose standard output can be read line by line; killed on destruction.
class ChildProcess {
 public:
  explicit ChildProcess(const std::vector<std::string>& command) {
    int output[2];
    if (pipe2(output, O_CLOEXEC) != 0)
      throw std::runtime_error("pipe failed");
    std::vector<char*> arguments;
    for (const std::string& argument : command)
      arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0)
      throw std::runtime_error("fork failed");
    if (pid_ == 0) {
      dup2(output[1], STDOUT_FILENO);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(output[1]);
    output_ = output[0];
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess() {
    kill();
    close(output_);
  }

  pid_t pid() const noexcept { return pid_; }

  /// The next line of its output without the line feed; what there was at the end of the output.
  std::string read_line() {
    std::string line;
    char c = 0;
    while (read(output_, &c, 1) == 1 && c != '\n')
      line.push_back(c);
    return line;
  }

  /// Whether there is something to read by now, which may be the end.
  bool has_output() const { return has_output_within(std::chrono::milliseconds(0)); }

  /// Waits for it.
  bool has_output_within(std::chrono::milliseconds patience) const {
    pollfd waits{output_, POLLIN, 0};
    return poll(&waits, 1, static_cast<int>(patience.count())) > 0;
  }

  void signal(int number) const { ::kill(pid_, number); }

  /// Waits for its end. \return exit code, or 128 + the signal that ended it.
  int wait() {
    if (is_running_)
      waitpid(pid_, &status_, 0);
    is_running_ = false;
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
  }

  /// SIGKILL, and waits for the end.
  void kill() {
    if (is_running_)
      signal(SIGKILL);
    wait();
  }

 private:
  pid_t pid_ = -1;
  int output_ = -1;
  int status_ = 0;
  bool is_running_ = true;
};

}  // namespace kinship::test

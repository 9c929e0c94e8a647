#include "client/experiments/pipeline/peer_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr int kThrew = 1;

void write_line(int descriptor, std::string line) {
  line.push_back('\n');
  for (std::size_t written = 0; written < line.size();) {
    const ssize_t count = write(descriptor, line.data() + written, line.size() - written);
    if (count < 0 && errno != EINTR)
      _exit(kThrew);  // nobody reads any more
    written += static_cast<std::size_t>(std::max<ssize_t>(count, 0));
  }
}

/// Whole lines only: what a crash cut off is no line.
void read_lines(int descriptor, const std::function<void(const std::string&)>& on_line) {
  std::string rest;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      return;
    rest.append(buffer.data(), static_cast<std::size_t>(count));
    for (std::size_t end = rest.find('\n'); end != std::string::npos; end = rest.find('\n')) {
      on_line(rest.substr(0, end));
      rest.erase(0, end + 1);
    }
  }
}

std::string end_of(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR)
      return std::strerror(errno);
  if (WIFSIGNALED(status))
    return "signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "exit code " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::string run_apart(
    const std::function<void(const std::function<void(const std::string&)>&)>& work,
    const std::function<void(const std::string&)>& on_line) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0)
    throw Failure(ErrorCode::Unavailable, std::string("no pipe: ") + std::strerror(errno));
  const pid_t self = getpid();
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw Failure(ErrorCode::Unavailable, std::string("no process: ") + std::strerror(errno));
  }
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    close(ends[0]);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (getppid() != self || nowhere < 0 || dup2(nowhere, STDOUT_FILENO) < 0)
      _exit(kThrew);
    try {
      work([&](const std::string& line) { write_line(ends[1], line); });
    } catch (const std::exception& error) {
      std::cerr << error.what() << std::endl;
      _exit(kThrew);
    }
    _exit(0);  // what the parent set up is the parent's to tear down
  }
  close(ends[1]);
  try {
    read_lines(ends[0], on_line);
  } catch (...) {
    close(ends[0]);
    end_of(child);
    throw;
  }
  close(ends[0]);
  return end_of(child);
}

}  // namespace kinship::experiments

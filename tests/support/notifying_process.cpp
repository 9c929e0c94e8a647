#include "tests/support/notifying_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace kinship::test {
namespace {

constexpr int kPatience_ms = 60'000;

[[noreturn]] void fail_of_system(const std::string& what) {
  throw std::system_error(errno, std::system_category(), what);
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

int exit_code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Becomes readable when the process has ended; -1 if there is none.
int open_process(pid_t pid) { return static_cast<int>(syscall(SYS_pidfd_open, pid, 0)); }

void wait_for_end(int process) {
  pollfd ended{.fd = process, .events = POLLIN, .revents = 0};
  while (poll(&ended, 1, -1) < 0 && errno == EINTR) {
  }
}

/// \param addition  "NAME=value", in the child's environment beside ours; empty: nothing.
pid_t spawn_with_log(const std::vector<std::string>& command, const std::filesystem::path& log,
                     std::string addition) {
  std::vector<char*> arguments;
  std::vector<std::string> words = command;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  for (char** entry = environ; *entry != nullptr; ++entry)
    environment.push_back(*entry);
  if (!addition.empty())
    environment.push_back(addition.data());
  environment.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_APPEND, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t pid = -1;
  const int error =
      posix_spawn(&pid, arguments[0], &actions, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw std::system_error(error, std::system_category(), "cannot start " + command.front());
  return pid;
}

}  // namespace

NotifyingProcess::NotifyingProcess(const std::vector<std::string>& command,
                                   const std::filesystem::path& socket, std::filesystem::path log)
    : log_(std::move(log)) {
  open_socket(socket);
  try {
    spawn(command, socket);
  } catch (...) {
    close(socket_);
    throw;
  }
}

NotifyingProcess::~NotifyingProcess() {
  kill_all();
  close(socket_);
}

void NotifyingProcess::open_socket(const std::filesystem::path& socket) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = socket.string();
  if (name.size() >= sizeof address.sun_path)
    throw std::invalid_argument("path of a socket is too long: " + name);
  std::memcpy(address.sun_path, name.data(), name.size());
  std::filesystem::remove(socket);
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0 || bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      chmod(name.c_str(), 0777) != 0)
    fail_of_system("socket " + name);
}

void NotifyingProcess::spawn(const std::vector<std::string>& command,
                             const std::filesystem::path& socket) {
  pid_ = spawn_with_log(command, log_, "NOTIFY_SOCKET=" + socket.string());
  is_running_ = true;
}

void NotifyingProcess::forget_readiness() const {
  char message = 0;
  while (recv(socket_, &message, sizeof message, 0) >= 0) {
  }
}

void NotifyingProcess::wait_until_ready() {
  const int process = open_process(pid_);
  pollfd events[2] = {{.fd = socket_, .events = POLLIN, .revents = 0},
                      {.fd = process, .events = POLLIN, .revents = 0}};
  std::string why;
  while (why.empty()) {
    char message[512];
    const ssize_t size = recv(socket_, message, sizeof message, 0);
    if (size >= 0) {
      const std::string_view said(message, static_cast<std::size_t>(size));
      if (said.find("READY=1") != std::string_view::npos)
        break;
      continue;
    }
    const int ready = poll(events, 2, kPatience_ms);
    if (ready == 0)
      why = "was not ready within a minute";
    else if (ready > 0 && events[0].revents == 0 && events[1].revents != 0)
      why = "ended before it was ready";
  }
  close(process);
  if (!why.empty())
    throw std::runtime_error("process " + std::to_string(pid_) + " " + why + "\n" + text_of(log_));
}

void NotifyingProcess::signal(int number) const {
  if (is_running_)
    ::kill(pid_, number);
}

int NotifyingProcess::wait() {
  if (is_running_)
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
  is_running_ = false;
  return exit_code_of(status_);
}

std::vector<pid_t> NotifyingProcess::children(std::string_view title) const {
  const std::string pid = std::to_string(pid_);
  std::ifstream list("/proc/" + pid + "/task/" + pid + "/children");
  std::vector<pid_t> found;
  for (pid_t child = 0; list >> child;)
    if (title.empty() ||
        text_of("/proc/" + std::to_string(child) + "/cmdline").find(title) != std::string::npos)
      found.push_back(child);
  return found;
}

void NotifyingProcess::kill_all() {
  if (!is_running_)
    return;
  signal(SIGSTOP);  // it starts nothing more while we look
  std::vector<int> processes;
  for (const pid_t child : children()) {
    processes.push_back(open_process(child));
    ::kill(child, SIGKILL);
  }
  signal(SIGKILL);
  wait();
  for (const int process : processes) {
    if (process < 0)
      continue;
    wait_for_end(process);
    close(process);
  }
}

void run_to_end(const std::vector<std::string>& command, const std::filesystem::path& log) {
  const pid_t pid = spawn_with_log(command, log, {});
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (exit_code_of(status) != 0)
    throw std::runtime_error(command.front() + " ended with " +
                             std::to_string(exit_code_of(status)) + "\n" + text_of(log));
}

}  // namespace kinship::test

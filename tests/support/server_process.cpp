#include "tests/support/server_process.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <system_error>

namespace kinship::test {
namespace {

void require_ok(int error, const std::string& what) {
  if (error != 0)
    throw std::system_error(error, std::system_category(), what);
}

/// What a child starts with: its outputs, and no signal blocked.
class SpawnSettings {
 public:
  SpawnSettings(int output, const std::filesystem::path& error_file) {
    require_ok(posix_spawn_file_actions_init(&actions_), "posix_spawn");
    require_ok(posix_spawnattr_init(&attributes_), "posix_spawn");
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    if (!error_file.empty())
      posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, error_file.c_str(),
                                       O_WRONLY | O_CREAT | O_APPEND, 0644);
  }
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;

  pid_t spawn(const std::string& program, const std::vector<std::string>& arguments) const {
    std::vector<std::string> words = {program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words)
      pointers.push_back(word.data());
    pointers.push_back(nullptr);
    pid_t pid = -1;
    require_ok(
        posix_spawn(&pid, program.c_str(), &actions_, &attributes_, pointers.data(), environ),
        "cannot start " + program);
    return pid;
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

std::vector<std::string> server_arguments(const ServerProcess::Options& options) {
  std::vector<std::string> arguments = {"--store", options.store.string(), "--domain",
                                        std::to_string(options.domain)};
  arguments.insert(arguments.end(), options.arguments.begin(), options.arguments.end());
  return arguments;
}

std::filesystem::path log_of(const ServerProcess::Options& options) {
  return options.log.empty() ? std::filesystem::path(options.store.string() + ".log") : options.log;
}

}  // namespace

Program::Program(const std::string& name, const std::vector<std::string>& arguments,
                 const std::filesystem::path& error_file) {
  int pipe_ends[2];
  if (pipe2(pipe_ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::system_category(), "pipe");
  output_ = pipe_ends[0];
  try {
    pid_ = SpawnSettings(pipe_ends[1], error_file)
               .spawn(std::filesystem::path(test::bin_dir()) / name, arguments);
  } catch (...) {
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    throw;
  }
  close(pipe_ends[1]);
}

Program::~Program() {
  kill();
  close(output_);
}

std::string Program::read_line() {
  std::string line;
  char c = 0;
  while (read(output_, &c, 1) == 1 && c != '\n')
    line.push_back(c);
  return line;
}

std::string Program::read_all() {
  std::string text;
  char c = 0;
  while (read(output_, &c, 1) == 1)
    text.push_back(c);
  return text;
}

bool Program::has_output_within(std::chrono::milliseconds patience) const {
  pollfd waits{output_, POLLIN, 0};
  return poll(&waits, 1, static_cast<int>(patience.count())) > 0;
}

void Program::signal(int number) const { ::kill(pid_, number); }

void Program::kill() {
  if (is_running_)
    signal(SIGKILL);
  wait();
}

bool Program::has_ended() const {
  siginfo_t state{};
  return !is_running_ ||
         (waitid(P_PID, static_cast<id_t>(pid_), &state, WEXITED | WNOHANG | WNOWAIT) == 0 &&
          state.si_pid != 0);
}

int Program::wait() {
  if (is_running_)
    waitpid(pid_, &status_, 0);
  is_running_ = false;
  return WIFEXITED(status_) ? WEXITSTATUS(status_) : 128 + WTERMSIG(status_);
}

std::vector<std::string> words(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> found;
  for (std::string word; stream >> std::quoted(word, '\'', '\0');)
    found.push_back(word);
  return found;
}

Answer run_to_end(const std::string& name, const std::vector<std::string>& arguments) {
  const TemporaryDirectory folder;
  Program program(name, arguments, folder / "err");
  Answer answer;
  answer.out = program.read_all();
  answer.code = program.wait();
  answer.err = read_text(folder / "err");
  return answer;
}

ServerProcess::ServerProcess(const Options& options)
    : program_("kinshipd", server_arguments(options), log_of(options)),
      ready_line_(program_.read_line()) {
  if (!ready_line_.starts_with("ready "))
    throw std::runtime_error("kinshipd ended with " + std::to_string(program_.wait()) +
                             " before it was ready: " + ready_line_ + "\n" +
                             read_text(log_of(options)));
}

int ServerProcess::terminate() {
  program_.signal(SIGTERM);
  return program_.wait();
}

void ServerProcess::kill() { program_.kill(); }

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace kinship::test

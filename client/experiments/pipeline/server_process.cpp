#include "client/experiments/pipeline/server_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

/// Where a child's output and messages go.
class FileActions {
 public:
  FileActions(int output, const std::filesystem::path& log) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, output, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions_, STDERR_FILENO, log.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, 0644);
  }
  ~FileActions() { posix_spawn_file_actions_destroy(&actions_); }
  FileActions(const FileActions&) = delete;
  FileActions& operator=(const FileActions&) = delete;

  const posix_spawn_file_actions_t* get() const noexcept { return &actions_; }

 private:
  posix_spawn_file_actions_t actions_{};
};

/// The next line without the line feed; what there was at the end of the output.
std::string read_line(int descriptor) {
  std::string line;
  char c = 0;
  while (read(descriptor, &c, 1) == 1 && c != '\n')
    line.push_back(c);
  return line;
}

}  // namespace

ServerProcess::ServerProcess(const Options& options) {
  if (!std::filesystem::exists(options.program))
    throw Failure(ErrorCode::NotFound,
                  "no kinshipd at '" + options.program.string() + "': give --kinshipd PATH");
  const std::string log = options.store.string() + ".log";
  std::vector<std::string> words = {options.program.string(),
                                    "--store",
                                    options.store.string(),
                                    "--domain",
                                    std::to_string(options.domain),
                                    "--workers",
                                    std::to_string(options.workers),
                                    "--fit-niceness",
                                    "0"};
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Failure(ErrorCode::Internal, std::string("pipe: ") + std::strerror(errno));
  output_ = ends[0];
  const int error = posix_spawn(&pid_, options.program.c_str(), FileActions(ends[1], log).get(),
                                nullptr, arguments.data(), environ);
  close(ends[1]);
  const std::string ready = error == 0 ? read_line(output_) : "";
  if (ready.starts_with("ready "))
    return;
  const std::string how =
      error == 0 ? "ended with " + std::to_string(wait_for_end()) : std::strerror(error);
  close(output_);
  throw Failure(ErrorCode::Unavailable,
                options.program.string() + " does not serve: " + how + ", see '" + log + "'");
}

ServerProcess::~ServerProcess() {
  kill(pid_, SIGTERM);
  wait_for_end();
  close(output_);
}

int ServerProcess::wait_for_end() {
  int status = 0;
  waitpid(pid_, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::filesystem::path sibling_program(const char* name) {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
}

}  // namespace kinship::experiments

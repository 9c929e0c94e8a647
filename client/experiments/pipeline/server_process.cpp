#include "client/experiments/pipeline/server_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

/// Starts a program that ends with this one, however this one ends: left alone it would keep the
/// store locked against the run that goes on.
/// \param output  becomes its standard output; its messages are appended to `log`.
/// \return        its process id; -1 if there is none.
pid_t start_program(char* const* arguments, int output, const char* log) {
  const pid_t self = getpid();
  const pid_t child = fork();
  if (child != 0)
    return child;
  // Between fork and exec: nothing but what a signal handler may call.
  constexpr int kMode = 0644, kCannotStart = 127;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int messages = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, kMode);
  if (getppid() == self && messages >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
      dup2(messages, STDERR_FILENO) >= 0)
    execv(arguments[0], arguments);
  _exit(kCannotStart);
}

/// The next line without the line feed; what there was at the end of the output.
std::string read_output_line(int descriptor) {
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
  pid_ = start_program(arguments.data(), ends[1], log.c_str());
  const int error = errno;
  close(ends[1]);
  const std::string ready = pid_ > 0 ? read_output_line(output_) : "";
  if (ready.starts_with("ready "))
    return;
  const std::string how =
      pid_ > 0 ? "ended with " + std::to_string(wait_for_end()) : std::strerror(error);
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

#include "robots/models/xacro.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include "proto/types/failure.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

constexpr const char* kProgram = "xacro";
constexpr std::size_t kShownBytes = 2000;  // of the program's message, its end

/// The sole owner of a file descriptor.
class Descriptor {
 public:
  explicit Descriptor(int descriptor) : descriptor_(descriptor) {
    if (descriptor < 0)
      throw Failure(ErrorCode::Internal, std::string(kProgram) + ": " + std::strerror(errno));
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  int get() const noexcept { return descriptor_; }
  void close() noexcept {
    if (descriptor_ >= 0)
      ::close(std::exchange(descriptor_, -1));
  }

 private:
  int descriptor_;
};

/// What can be read from a descriptor, of at most `max_bytes` and one more.
std::string read_up_to(const Descriptor& from, std::size_t max_bytes) {
  std::string text;
  std::string part(65'536, '\0');
  while (text.size() <= max_bytes) {
    const ssize_t count = ::read(from.get(), part.data(), part.size());
    if (count < 0 && errno == EINTR)
      continue;
    if (count <= 0)
      break;
    text.append(part, 0, static_cast<std::size_t>(count));
  }
  return text;
}

struct ProgramResult {
  int start_error = 0;  ///< errno of a program that did not start
  int status = 0;       ///< as waitpid() tells it
  std::string output;   ///< one byte more than `max_bytes` if there was more
  std::string message;  ///< the end of its standard error
};

/// Runs the program without a shell.
ProgramResult run(const std::vector<std::string>& words, std::size_t max_bytes) {
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Failure(ErrorCode::Internal, std::string(kProgram) + ": " + std::strerror(errno));
  const Descriptor output(ends[0]);
  Descriptor input(ends[1]);
  const Descriptor errors(memfd_create(kProgram, MFD_CLOEXEC));  // a full pipe would stop it
  std::vector<char*> arguments;
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT: what POSIX asks for
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input.get(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, errors.get(), STDERR_FILENO);
  ProgramResult result;
  pid_t process = -1;
  result.start_error =
      posix_spawnp(&process, kProgram, &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (result.start_error != 0)
    return result;
  input.close();
  result.output = read_up_to(output, max_bytes);
  if (result.output.size() > max_bytes)
    kill(process, SIGKILL);
  while (waitpid(process, &result.status, 0) < 0 && errno == EINTR) {
  }
  const off_t size = lseek(errors.get(), 0, SEEK_END);
  lseek(errors.get(), std::max<off_t>(0, size - static_cast<off_t>(kShownBytes)), SEEK_SET);
  result.message = read_up_to(errors, kShownBytes);
  result.message.resize(result.message.find_last_not_of(" \r\n") + 1);
  return result;
}

std::string expand(const std::filesystem::path& file, const Error& unexpanded,
                   const XacroInput& input) {
  // From the root: a name that begins with '-' would be an option.
  std::vector<std::string> words = {kProgram, std::filesystem::absolute(file).string()};
  words.insert(words.end(), input.arguments.begin(), input.arguments.end());
  const ProgramResult result = run(words, input.max_bytes);
  if (result.start_error == ENOENT)
    throw Failure(unexpanded);
  const auto refuse = [&](ErrorCode code, const std::string& why) {
    throw Failure(code, "'" + file.string() + "': xacro: " + why);
  };
  if (result.start_error != 0)
    refuse(ErrorCode::InvalidInput, std::strerror(result.start_error));
  if (result.output.size() > input.max_bytes)
    refuse(ErrorCode::TooLarge,
           "what it makes exceeds " + std::to_string(input.max_bytes) + " bytes");
  if (result.status != 0)
    refuse(ErrorCode::InvalidInput,
           "it failed (" +
               (WIFEXITED(result.status) ? "exit code " + std::to_string(WEXITSTATUS(result.status))
                                         : "signal " + std::to_string(WTERMSIG(result.status))) +
               "): " + result.message);
  return result.output;
}

}  // namespace

std::string read_expanded(const std::filesystem::path& file, const XacroInput& input) {
  for (const std::string& argument : input.arguments)
    if (const std::size_t at = argument.find(":=");
        at == 0 || at == std::string::npos || argument.starts_with('-'))
      throw Failure(ErrorCode::InvalidInput,
                    "--xacro-argument '" + argument + "': must be NAME:=VALUE");
  std::string text = read_text(file, input.max_bytes);
  const auto unexpanded = check_expanded(file, text, input.ending);
  if (unexpanded)
    return expand(file, *unexpanded, input);
  return text;
}

}  // namespace kinship::models

#include "client/experiments/python_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <iostream>

#include "proto/types/exit_code.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr const char* kPython = "/usr/bin/python3";

std::vector<std::string> command_of(const std::filesystem::path& program,
                                    const std::vector<std::string>& arguments) {
  if (!std::filesystem::exists(program))
    throw Failure(ErrorCode::NotFound, "no program '" + program.string() + "'");
  std::vector<std::string> words = {kPython, "-B", program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

/// As exec takes them. \param words  outlive them.
std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words)
    pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

Failure no_python(int error) {
  return {ErrorCode::NotFound, std::string(kPython) + ": " + std::strerror(error) +
                                   "; on Debian: apt-get install python3 python3-numpy"};
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t count = 0; (count = read(descriptor, buffer.data(), buffer.size())) != 0;)
    if (count > 0)
      text.append(buffer.data(), static_cast<std::size_t>(count));
    else if (errno != EINTR)
      break;
  return text;
}

}  // namespace

std::filesystem::path python_folder() { return KINSHIP_EXPERIMENTS_DIR; }

void become_python(const std::filesystem::path& program,
                   const std::vector<std::string>& arguments) {
  std::vector<std::string> words = command_of(program, arguments);
  std::cout.flush();
  execv(kPython, pointers_to(words).data());
  throw no_python(errno);
}

std::string output_of_python(const std::filesystem::path& program,
                             const std::vector<std::string>& arguments) {
  std::vector<std::string> words = command_of(program, arguments);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Failure(ErrorCode::Internal, std::string("pipe: ") + std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, kPython, &actions, nullptr, pointers_to(words).data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text = error == 0 ? read_all(ends[0]) : "";
  close(ends[0]);
  if (error != 0)
    throw no_python(error);
  int status = 0;
  if (waitpid(process, &status, 0) != process || status != 0)
    throw Failure(WIFEXITED(status) && WEXITSTATUS(status) == kNotFound ? ErrorCode::NotFound
                                                                        : ErrorCode::InvalidInput,
                  program.filename().string() + " has failed");
  return text;
}

}  // namespace kinship::experiments

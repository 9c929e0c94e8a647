#include "client/experiments/python_program.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <iostream>

#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::filesystem::path python_folder() { return KINSHIP_EXPERIMENTS_DIR; }

void become_python(const std::filesystem::path& program, std::vector<std::string> arguments) {
  constexpr const char* kPython = "/usr/bin/python3";
  if (!std::filesystem::exists(program))
    throw Failure(ErrorCode::NotFound, "no program '" + program.string() + "'");
  std::cout.flush();
  arguments.insert(arguments.begin(), {kPython, "-B", program.string()});
  std::vector<char*> words;
  for (std::string& word : arguments)
    words.push_back(word.data());
  words.push_back(nullptr);
  execv(kPython, words.data());
  throw Failure(ErrorCode::NotFound, std::string(kPython) + ": " + std::strerror(errno) +
                                         "; on Debian: apt-get install python3");
}

}  // namespace kinship::experiments

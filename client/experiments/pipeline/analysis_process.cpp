#include "client/experiments/pipeline/analysis_process.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <iostream>

namespace kinship::experiments {
namespace {

/// Debian's, for which the packages are; another one in the path need not have them.
constexpr const char* kPython = "/usr/bin/python3";

std::vector<std::string> words_of(const AnalysisRun& run) {
  std::vector<std::string> words = {kPython, run.script.string(), run.folder.string()};
  if (!run.option.empty())
    words.push_back(run.option);
  return words;
}

}  // namespace

std::string AnalysisRun::command() const {
  std::string text;
  for (const std::string& word : words_of(*this))
    text += (text.empty() ? "" : " ") + word;
  return text;
}

bool run_analysis(const AnalysisRun& run) {
  std::cout.flush();
  std::vector<std::string> words = words_of(run);
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error = posix_spawn(&process, kPython, nullptr, nullptr, arguments.data(), environ);
  if (error != 0) {
    std::cerr << kPython << ": " << std::strerror(error) << "; on Debian: apt-get install python3"
              << std::endl;
    return false;
  }
  int status = 0;
  return waitpid(process, &status, 0) == process && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace kinship::experiments

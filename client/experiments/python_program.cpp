#include "client/experiments/python_program.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr const char* kPython = "/usr/bin/python3";

}  // namespace

void become_python(const std::string& script, const CLI::App& command, const nlohmann::json& more) {
  const std::filesystem::path program = std::filesystem::path(KINSHIP_EXPERIMENTS_DIR) / script;
  if (!std::filesystem::exists(program))
    throw Failure(ErrorCode::NotFound, "no program '" + program.string() + "'");
  nlohmann::json words{{"program", {std::filesystem::read_symlink("/proc/self/exe").string()}}};
  for (const CLI::Option* option : command.get_options()) {
    const std::string& name = option->get_lnames().front();  // get_name() of a hidden one is empty
    if (option->count() > 0)
      words[name] = option->results();
    else if (!option->get_default_str().empty())
      words[name] = {option->get_default_str()};
  }
  words.update(more);
  std::cout.flush();
  execl(kPython, kPython, "-B", program.c_str(), words.dump().c_str(), nullptr);
  throw Failure(ErrorCode::NotFound, std::string(kPython) + ": " + std::strerror(errno) +
                                         "; on Debian: apt-get install python3 python3-numpy");
}

}  // namespace kinship::experiments

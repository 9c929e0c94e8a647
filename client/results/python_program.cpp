#include "client/results/python_program.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

#include "proto/files/installed_place.hpp"
#include "proto/types/failure.hpp"

namespace kinship::results {
namespace {

constexpr const char* kPython = "/usr/bin/python3";

}  // namespace

Words words_of(const CLI::App& command) {
  Words words;
  for (const CLI::Option* option : command.get_options()) {
    const std::string& name = option->get_lnames().front();  // get_name() of a hidden one is empty
    if (option->count() > 0)
      words[name] = option->results();
    else if (!option->get_default_str().empty())
      words[name] = {option->get_default_str()};
  }
  return words;
}

std::filesystem::path script(const std::string& name) {
  return files::installed_place(std::filesystem::path("results") / name,
                                std::filesystem::path(KINSHIP_RESULTS_DIR) / name);
}

void become_python(const std::filesystem::path& program, Words words) {
  if (!std::filesystem::exists(program))
    throw Failure(ErrorCode::NotFound, "no program '" + program.string() + "'");
  words["program"] = {files::own_program().string()};
  const std::string told = nlohmann::json(words).dump();
  std::cout.flush();
  execl(kPython, kPython, "-B", program.c_str(), told.c_str(), nullptr);
  throw Failure(ErrorCode::NotFound, std::string(kPython) + ": " + std::strerror(errno) +
                                         "; on Debian: apt-get install python3");
}

}  // namespace kinship::results

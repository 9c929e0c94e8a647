#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::experiments {

/// Runs a program of this folder in Debian's Python, whose packages are what Kinship is tested
/// with, in place of this program. It gets one argument, a JSON document: by name a list of
/// words for each option of the command, as given or its default, "program", this one, and `more`.
/// \throws Failure(NotFound) without the program or Python.
[[noreturn]] void become_python(const std::string& script, const CLI::App& command,
                                const nlohmann::json& more = nlohmann::json::object());

}  // namespace kinship::experiments

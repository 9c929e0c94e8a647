#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::results {

/// What a program in Python is told: by name, a list of words.
using Words = std::map<std::string, std::vector<std::string>>;

/// By name of each option of a command, its words as they were given, or its default.
Words words_of(const CLI::App& command);

/// Where compare.py and page.py are: share/kinship/results beside the folder of this program, or
/// the sources that it was built from.
std::filesystem::path script(const std::string& name);

/// Runs a program in Debian's Python, whose packages are what Kinship is tested with, in place of
/// this program. It gets the words as one argument, a JSON document, with "program", this one.
/// \throws Failure(NotFound) without the program or Python.
[[noreturn]] void become_python(const std::filesystem::path& program, Words words);

}  // namespace kinship::results

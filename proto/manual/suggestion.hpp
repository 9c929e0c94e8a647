#pragma once

#include <iosfwd>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
class ParseError;
}  // namespace CLI

namespace kinship::manual {

/// What a misspelt word of a command line may have meant, for the end of a line about it:
/// " (did you mean 'register'?)"; empty if nothing is near. Verbs are sought among those of the
/// deepest verb that was understood, options ("--...") among its own and those above it.
std::string suggestion_for(const CLI::App& app, const std::string& word);

/// Says what is wrong with a command line, what a misspelt word may have meant, or what --help and
/// --version are asked for.
/// \return an exit code (proto/types/exit_code.hpp).
int explain(const CLI::App& app, const CLI::ParseError& error, std::ostream& out,
            std::ostream& err);

}  // namespace kinship::manual

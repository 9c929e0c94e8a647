#pragma once

#include <iosfwd>
#include <string>

namespace CLI {  // NOLINT: theirs
class App;
class ParseError;
}  // namespace CLI

namespace kinship::manual {

/// A correction of a misspelt word of a command line, to append to a message: " (did you mean
/// 'register'?)"; empty if no name is near. Verbs are searched among those of the deepest verb that
/// was recognised, options ("--...") among its own and those above it.
std::string suggestion_for(const CLI::App& app, const std::string& word);

/// Writes the fault of a command line with corrections of misspelt words, or the text of --help and
/// --version; to a line that ends where a verb is wanted, the help of what is there. An unknown
/// option is told before other faults of the line, which may come of it.
/// \return an exit code (proto/types/exit_code.hpp).
int explain(const CLI::App& app, const CLI::ParseError& error, std::ostream& out,
            std::ostream& err);

}  // namespace kinship::manual

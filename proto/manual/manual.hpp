#pragma once

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::manual {

/// Adds the options of every program: --version, --completion SHELL, --man-page, and help that fits
/// 80 columns. Call it before options and verbs are added.
/// \param app      has its name.
/// \param section  of the manual: 1 for user programs, 8 for servers.
void add_manual(CLI::App& app, int section = 1);

/// Reads a command line of a program with verbs. `help VERB...` is `VERB... --help`, `version` is
/// --version.
/// \throws CLI::ParseError, for explain() (suggestion.hpp).
void parse(CLI::App& app, int argc, const char* const* argv);

}  // namespace kinship::manual

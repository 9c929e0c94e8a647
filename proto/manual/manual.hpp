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

/// Type name of an option that takes a list of numbers: parse() joins the words of it, so that
/// `--q 0 -1.5 2` is `--q "0 -1.5 2"`.
inline constexpr const char* kNumbers = "NUMBERS";

}  // namespace kinship::manual

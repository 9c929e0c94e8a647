#pragma once

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::manual {

/// What every program has: --version, --completion SHELL, --man-page, and help that fits 80
/// columns. To be called before options and verbs are added.
/// \param app      has its name.
/// \param section  of the manual: 1 for people's programs, 8 for servers.
void add_manual(CLI::App& app, int section = 1);

}  // namespace kinship::manual

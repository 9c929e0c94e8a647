#pragma once

#include <iosfwd>

namespace kinship::cli {

/// The program `kinship`: parses the command line and runs one command.
/// \return the exit code.
int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err);

}  // namespace kinship::cli

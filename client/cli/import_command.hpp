#pragma once

#include <filesystem>
#include <iosfwd>

#include "client/link/client.hpp"

namespace kinship::cli {

struct ImportOptions {
  std::filesystem::path file;  ///< "-": `standard_input`
  bool json = false;           ///< the counts as one document
  bool progress = false;       ///< names the last delivered line on `err`
};

/// `paths import`: sends the lines of an experience file to the server; registers the robots that
/// it describes. May be repeated: the server recognizes stored reports by their UUID.
/// \return kFailed if a line was refused (each is named on `err`); kNoServer if no server answered.
/// \throws Failure if the file cannot be read.
int import_paths(link::Client& server, const ImportOptions& options, std::istream& standard_input,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli

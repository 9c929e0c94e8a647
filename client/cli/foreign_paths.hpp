#pragma once

#include <iosfwd>

#include "client/cli/path_import.hpp"

namespace kinship::cli {

/// `paths import --moveit-warehouse` and `--ompl-planner-data`: paths that other programs have
/// kept, as attempts that were planned uniformly, which are no evidence for or against guidance. A
/// report's UUID is made of its content, so that an import may be repeated.
/// \return as import_paths().
int import_foreign_paths(link::Client& server, const ImportOptions& options, std::ostream& out,
                         std::ostream& err);

}  // namespace kinship::cli

#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "server/store/moving/side.hpp"

namespace kinship::store::moving {

/// A file that is moved from. A server may have it open: then it is read beside that, in short
/// snapshots, and never written; else its lock is held.
/// \throws Failure(NotFound) if it is not there; Failure(Storage) if it is no store of today's
///         schema.
std::unique_ptr<Side> open_sqlite_source(const std::filesystem::path& file);

/// A file that is moved to, made if it is not there; its lock is held.
/// \throws Failure(Unavailable) if a server has it open.
std::unique_ptr<Side> open_sqlite_target(const std::filesystem::path& file);

}  // namespace kinship::store::moving

#pragma once

#include <filesystem>
#include <memory>

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// The only connection that writes and checkpoints: WAL, synchronous FULL, foreign keys on, no
/// automatic checkpoint; makes the file (pages of 4 KB) and brings its schema up to date. The WAL
/// of a killed server is made durable before anything is read from it.
/// \throws Failure(Storage) if the file is no Kinship store or newer than this binary;
///         Failure(Unavailable) if it is filled by a move, or was moved elsewhere.
std::unique_ptr<Database> open_writer(const std::filesystem::path& file);

/// Opens the writing connection again after a failure, when no other one of this process is open.
/// The file must exist; its WAL is made durable and checkpointed completely. It must have the
/// newest schema and accept a commit, which also quarantines the damaged ones of the newest paths:
/// damage must not keep the store closed.
/// \throws Failure(Storage) if not.
std::unique_ptr<Database> reopen_writer(const std::filesystem::path& file);

/// A connection that only reads and never checkpoints.
std::unique_ptr<Database> open_reader(const std::filesystem::path& file,
                                      Access access = Access::ReadOnly);

/// The same for a store that shall stay as it is: without a WAL nothing is made beside it, a WAL is
/// left alone at the end, as it may be a server's.
std::unique_ptr<Database> open_unchanged(const std::filesystem::path& file);

}  // namespace kinship::store

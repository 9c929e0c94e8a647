#pragma once

#include <filesystem>
#include <memory>

#include "server/store/sqlite/database/database.hpp"

namespace kinship::store {

/// The only connection that writes and checkpoints: WAL, synchronous FULL, foreign keys on, no
/// automatic checkpoint; makes the file (pages of 4 KB) and brings its schema up to date. What a
/// killed server left in the WAL is made durable before anything is read from it.
/// \throws Failure(Storage) if the file is no Kinship store or newer than this binary;
///         Failure(Unavailable) if it is half moved, or was moved elsewhere.
std::unique_ptr<Database> open_writer(const std::filesystem::path& file);

/// Opens the writing connection again after a failure, when no other one of this process is open.
/// The file must be there; its WAL is made durable and brought into it as a whole. It must have the
/// newest schema, its newest paths readable, and must accept a commit, which also sets aside those
/// of the newest paths that are damaged: damage must not keep the store closed to all others.
/// \throws Failure(Storage) if not.
std::unique_ptr<Database> reopen_writer(const std::filesystem::path& file);

/// A connection that only reads, and never checkpoints.
std::unique_ptr<Database> open_reader(const std::filesystem::path& file);

}  // namespace kinship::store

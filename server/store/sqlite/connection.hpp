#pragma once

#include <filesystem>
#include <memory>

#include "server/store/sqlite/database.hpp"

namespace kinship::store {

/// The only connection that writes and checkpoints: WAL, synchronous FULL, foreign keys on; makes
/// the file (pages of 8 KB) and brings its schema up to date.
/// \throws Failure(Storage) if the file is no Kinship store or newer than this binary.
std::unique_ptr<Database> open_writer(const std::filesystem::path& file);

/// Opens the writing connection again after a failure: the file must be there, with the newest
/// schema, its newest paths readable, and must accept a commit, which also sets aside those of the
/// newest paths that are damaged: damage must not keep the store closed to all others.
/// \throws Failure(Storage) if not.
std::unique_ptr<Database> reopen_writer(const std::filesystem::path& file);

/// A connection that only reads, and never checkpoints.
std::unique_ptr<Database> open_reader(const std::filesystem::path& file);

}  // namespace kinship::store

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"

/// Stores to be moved, and what is in them, past the code that moves them.
namespace kinship::test {

/// The newest golden store, and what that one lacks: a removed robot, a renamed one, distributions,
/// paths and a scene that are damaged, some of it noticed. All that a store can hold.
void make_full_store(const std::filesystem::path& file);

/// Reports that the store has beside those of the golden one, in use and not damaged.
std::vector<Attempt> attempts_of_full_store();

/// A store of one robot with as many attempts, one in four unsolved.
void make_large_store(const std::filesystem::path& file, std::uint64_t attempts);

/// All rows of an SQLite store as text, by table: what a move has to bring. Without what belongs to
/// one store alone (its epoch, what was done to it by a move).
std::map<std::string, std::multiset<std::string>> rows_of(const std::filesystem::path& file);

/// What one of two such stores has and the other has not, in words; empty: they hold the same.
std::string differences_of(const std::filesystem::path& one, const std::filesystem::path& other);

/// Reads one number of a store that others may write to; 0 while it is no store.
std::int64_t number_in(const std::filesystem::path& file, const std::string& sql);

}  // namespace kinship::test

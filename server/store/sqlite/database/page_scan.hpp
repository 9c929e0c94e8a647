#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/store/sqlite/database/database.hpp"

struct sqlite3_file;

/// Pages of a database file, read without SQLite's b-trees.
namespace kinship::store {

/// Reads pages of a sealed file past SQLite's cache. A page that is being written meanwhile may
/// look damaged. Used by one thread at a time, as its connection is.
class PageReader {
 public:
  /// \param database  must live longer.
  explicit PageReader(Database& database);
  /// For a database whose header cannot be read.
  PageReader(Database& database, std::size_t page_size);

  std::uint64_t count() const;  ///< of pages in the file now
  std::size_t page_size() const noexcept { return bytes_.size(); }

  /// \return the page, valid until the next call; nothing if it is damaged.
  /// \throws Failure(Storage) if the file cannot be read.
  std::optional<std::span<const std::uint8_t>> read(std::uint64_t number);

 private:
  sqlite3_file* file_;
  std::vector<std::uint8_t> bytes_;
};

/// The owner of a page.
struct PageOwner {
  std::string table;  ///< empty: unknown
  std::string words;  ///< "table path", "index path_by_content", "free"
};

/// Finds the owners of some pages, reading every page of the file if need be. The owner of a page
/// below a damaged one, or not found before the deadline, stays unknown. Holds no snapshot
/// meanwhile.
/// \param pages  in order.
/// \return one owner for each.
std::map<std::uint64_t, PageOwner> owners_of(
    Database& database, const std::vector<std::uint64_t>& pages,
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max());

}  // namespace kinship::store

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <vector>

struct sqlite3;

/// SQLite's file layer (VFS), with a checksum at the end of every page. SQLite itself has none: of
/// 400 flipped bits 372 were read as data.
///
/// A page gets its checksum (page_seal.hpp) when it is written to the database file, not before:
/// its copy in the WAL has SQLite's checksum of the frame. Reading a page with a wrong checksum
/// from the file, or from the WAL a page that differs from the written one (wal_frames.hpp), gives
/// kDamagedPage and notes the page. A file is sealed, with checksums on all pages, or not: byte 20
/// of its header tells. The size of pages of a sealed file is not changed in place: SQLite then
/// writes pages of one size over those of another.
namespace kinship::store {

/// The damaged pages of one database file that this process has read. May be shared between
/// threads.
class PageDamage {
 public:
  static constexpr std::size_t kMaxPages = 1000;

  /// \param page  counted from 1. Beyond kMaxPages no more are noted.
  void note(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (pages_.size() < kMaxPages)
      pages_.insert(page);
  }
  /// The page was written anew.
  void forget(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    pages_.erase(page);
  }
  /// In order.
  std::vector<std::uint64_t> pages() const {
    const std::lock_guard lock(mutex_);
    return {pages_.begin(), pages_.end()};
  }

 private:
  mutable std::mutex mutex_;
  std::set<std::uint64_t> pages_;  // guarded by mutex_
};

/// SQLite's result code for a page whose checksum is wrong: an extended code of SQLITE_CORRUPT
/// unknown to SQLite itself, so that it neither rolls the transaction back (as after SQLITE_IOERR)
/// nor forbids further writes (as after SQLITE_CORRUPT): the page was not loaded, and a savepoint
/// undoes its part.
inline constexpr int kDamagedPage = 11 | (75 << 8);

/// The name of the VFS to open a database with; the first call registers it at SQLite. It passes
/// all calls on to SQLite's default VFS at the time when the file is opened.
const char* checked_vfs();

/// Makes an empty database sealed, as all stores are. Others stay as they are.
void seal_if_empty(sqlite3& connection);
/// Tells the target of a copy whether its source is sealed.
void set_sealed(sqlite3& connection, bool sealed);
bool is_sealed(sqlite3& connection);

/// The damaged pages of a connection's file, found by any connection of this process.
std::shared_ptr<PageDamage> damage_of(sqlite3& connection);

/// From now on this connection writes each commit to its WAL in one piece, when it syncs. Does
/// nothing unless `PRAGMA synchronous` is FULL: with less, SQLite shows readers a commit that is
/// not synced and would not yet be in the file.
/// \param connection  one whose WAL is open.
void gather_wal_writes(sqlite3& connection);

/// Lets this thread read holes of a file: pages that were never written, which SQLite reads only
/// for a copy.
class HolesAllowed {
 public:
  HolesAllowed();
  HolesAllowed(const HolesAllowed&) = delete;
  HolesAllowed& operator=(const HolesAllowed&) = delete;
  ~HolesAllowed();
};

}  // namespace kinship::store

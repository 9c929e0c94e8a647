#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <vector>

struct sqlite3;

/// SQLite's way to the disk, with a checksum at the end of every page. SQLite itself has none: of
/// 400 flipped bits 372 came out as data.
///
/// A page is sealed (page_seal.hpp) on its way into the database file, never before: the copy of it
/// in the WAL stands under SQLite's checksum of the frame. A page read from the file whose seal is
/// wrong, or from the WAL and other than it was written (wal_frames.hpp), is kDamagedPage and is
/// noted. A file is sealed or not as a whole: byte 20 of its header says so. The size of pages of a
/// sealed file is not changed in place: SQLite then writes pages of one size over those of another.
namespace kinship::store {

/// The damaged pages of one database file that this process has met. May be shared between threads.
class PageDamage {
 public:
  static constexpr std::size_t kMaxPages = 1000;

  /// \param page  counted from 1. Beyond kMaxPages no more are noted.
  void note(std::uint64_t page) {
    const std::lock_guard lock(mutex_);
    if (pages_.size() < kMaxPages)
      pages_.insert(page);
  }
  /// It was written anew.
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

/// SQLite's result code for a page whose checksum is wrong: an extended code of SQLITE_CORRUPT that
/// SQLite itself has not, so that it neither rolls the transaction back (as it does after
/// SQLITE_IOERR) nor forbids to write on (as after SQLITE_CORRUPT): the page was not let in, and
/// what a savepoint undoes is undone.
inline constexpr int kDamagedPage = 11 | (75 << 8);

/// The name to open a database with; made known to SQLite by the first call. Passes everything on
/// to what is SQLite's default when the file is opened.
const char* checked_vfs();

/// Seals a database that is still empty, as all stores are. Others stay as they are.
void seal_if_empty(sqlite3& connection);
/// Says of a database that is being copied to whether what it is a copy of is sealed.
void set_sealed(sqlite3& connection, bool sealed);
bool is_sealed(sqlite3& connection);

/// What was found damaged in the file of a connection, by any connection of this process.
std::shared_ptr<PageDamage> damage_of(sqlite3& connection);

/// From now on this connection writes a commit to its WAL at once, when it syncs it. Does nothing
/// unless `PRAGMA synchronous` is FULL: with less SQLite tells readers of a commit that was not
/// synced, and so would not be in the file.
/// \param connection  one whose WAL is open.
void gather_wal_writes(sqlite3& connection);

/// Lets this thread read holes of a file: pages that nobody ever wrote, which SQLite reads for a
/// copy alone.
class HolesAllowed {
 public:
  HolesAllowed();
  HolesAllowed(const HolesAllowed&) = delete;
  HolesAllowed& operator=(const HolesAllowed&) = delete;
  ~HolesAllowed();
};

}  // namespace kinship::store

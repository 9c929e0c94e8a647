#pragma once

#include "server/store/sqlite/database/page_seal.hpp"

struct sqlite3_file;
struct sqlite3_vfs;

/// The files that checked_vfs() opens.
namespace kinship::store {

extern const int kCheckedFileBytes;  ///< that SQLite has to allocate for one

/// Questions to an open database file, for sqlite3_file_control(); SQLite's own are below 100.
inline constexpr int kSealIfEmpty = 7501;  ///< SQLITE_OK if it was empty and will be sealed
inline constexpr int kSetSealed = 7502;    ///< takes a bool
inline constexpr int kTellSealed = 7503;   ///< gives a bool
inline constexpr int kTellDamage = 7504;   ///< gives a shared_ptr<PageDamage>

/// \param base  opens the file itself; the other parameters are those of sqlite3_vfs::xOpen.
/// \return SQLite's result code.
int open_checked(sqlite3_vfs& base, const char* name, sqlite3_file* file, int flags,
                 int* flags_out);

/// From now on the pieces that are written to this WAL are gathered until it is synced or read.
/// \throws std::logic_error if open_checked() did not open it.
void gather_writes(sqlite3_file& file);

}  // namespace kinship::store

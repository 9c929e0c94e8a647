#pragma once

#include <cstdint>
#include <string>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/files/disk_space.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"
#include "server/store/store.hpp"

/// Whether there is room for reports, what the disk did, and what is damaged, in words.
namespace kinship::store {

/// Empty if reports are taken; else why not.
std::string lack_of_room(const DiskSpace& space, const Writer& writer, const ReaderPool& readers,
                         std::uint64_t max_wal_bytes);

/// \param lack  of room, in words; empty: none.
void describe_disk(StoreStatus& status, const DiskSpace& space, const Writer& writer,
                   const std::string& lack);

/// \param findings  of the search for damage.
void describe_damage(StoreStatus& status, std::size_t damaged_robots, const std::string& findings);

}  // namespace kinship::store

#pragma once

#include <cstdint>
#include <string>

#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/files/disk_space.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"
#include "server/store/store.hpp"

/// Texts about room for reports, failures of the disk and damage.
namespace kinship::store {

/// Empty if reports are accepted; else the reason why not.
std::string out_of_space_reason(const DiskSpace& space, const Writer& writer,
                                const ReaderPool& readers, std::uint64_t max_wal_bytes);

/// \param lack  result of out_of_space_reason().
void describe_disk(StoreStatus& status, const DiskSpace& space, const Writer& writer,
                   const std::string& lack);

/// \param findings  of the search for damage.
void describe_damage(StoreStatus& status, std::size_t damaged_robots, const std::string& findings);

}  // namespace kinship::store

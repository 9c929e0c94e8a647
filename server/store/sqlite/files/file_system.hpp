#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinship::store {

/// Name of the network filesystem of this statfs(2) type (NFS, SMB, 9P ...); empty for all others.
/// FUSE counts as none: what lies behind it the system does not tell.
std::string network_filesystem_of(long type);

/// Nothing if a store may lie in `directory`, which must exist.
/// \throws Failure(Storage) where it lies on a network filesystem: locks and syncs that a store
///         relies upon hold there for one machine at best, and memory cannot be shared
///         (https://sqlite.org/wal.html, "Overview", and https://sqlite.org/useovernet.html).
void require_local_filesystem(const std::filesystem::path& file,
                              const std::filesystem::path& directory);

/// What the error of a file means to who chose its place, and what to change; the system's words
/// for all others.
/// \param reason  an errno
std::string explain_file_error(int reason, const std::filesystem::path& directory);

/// Which file a store is, as one text: inode and time of birth (statx), without the device, whose
/// number changes between boots. A copy has another one, a renamed file the same.
/// \throws Failure(Storage) if the file system cannot say.
std::string identity_of(const std::filesystem::path& file);

/// Whether two identities can be of one file; where a file system keeps no time of birth the inode
/// alone decides.
bool may_be_same_file(std::string_view a, std::string_view b);

}  // namespace kinship::store

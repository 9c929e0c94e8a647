#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinship::store {

/// Name of the network filesystem of this statfs(2) type (NFS, SMB, 9P ...); empty for all others.
/// FUSE counts as none: the system does not tell what is behind it.
std::string network_filesystem_of(long type);

/// Returns if a store may lie in `directory`, which must exist.
/// \throws Failure(Storage) on a network filesystem: locks and syncs that a store relies upon hold
///         there for one machine at best, and memory cannot be shared (https://sqlite.org/wal.html,
///         "Overview", and https://sqlite.org/useovernet.html).
void require_local_filesystem(const std::filesystem::path& file,
                              const std::filesystem::path& directory);

/// Whether the file itself is mounted (mount --bind, Docker's -v FILE:FILE), not a folder above it.
bool is_mount_point(const std::filesystem::path& file);

/// Explains the error of a file, with what to change about its place; other errors in the system's
/// words.
/// \param reason  an errno
std::string explain_file_error(int reason, const std::filesystem::path& directory);

/// Identity of a store's file, as one text: inode and time of birth (statx), without the device,
/// whose number changes between boots. A copy has another identity, a renamed file the same.
/// \throws Failure(Storage) if the file system cannot say.
std::string identity_of(const std::filesystem::path& file);

/// Whether two identities can be of one file; without a time of birth the inode alone decides.
bool may_be_same_file(std::string_view a, std::string_view b);

}  // namespace kinship::store

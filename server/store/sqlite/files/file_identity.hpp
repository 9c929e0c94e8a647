#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kinship::store {

/// Which file a store is, as one text: inode and time of birth (statx), without the device, whose
/// number changes between boots. A copy has another one, a renamed file the same.
/// \throws Failure(Storage) if the file system cannot say.
std::string identity_of(const std::filesystem::path& file);

/// Whether two identities can be of one file; where a file system keeps no time of birth the inode
/// alone decides.
bool may_be_same_file(std::string_view a, std::string_view b);

}  // namespace kinship::store

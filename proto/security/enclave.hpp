#pragma once

#include <filesystem>

namespace kinship::security {

/// The files of an enclave of SROS 2, as `ros2 security create_enclave` makes them.
struct EnclaveFiles {
  static EnclaveFiles in(const std::filesystem::path& folder);

  std::filesystem::path identity_authority;
  std::filesystem::path certificate;
  std::filesystem::path key;
  std::filesystem::path permissions_authority;
  std::filesystem::path governance;
  std::filesystem::path permissions;
};

/// \throws Failure(NotFound) that names the first file that cannot be read. What is in them Cyclone
///         DDS checks when a participant joins.
void require_enclave(const std::filesystem::path& folder);

}  // namespace kinship::security

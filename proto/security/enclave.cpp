#include "proto/security/enclave.hpp"

#include <fstream>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::security {

EnclaveFiles EnclaveFiles::in(const std::filesystem::path& folder) {
  return {.identity_authority = folder / "identity_ca.cert.pem",
          .certificate = folder / "cert.pem",
          .key = folder / "key.pem",
          .permissions_authority = folder / "permissions_ca.cert.pem",
          .governance = folder / "governance.p7s",
          .permissions = folder / "permissions.p7s"};
}

void require_enclave(const std::filesystem::path& folder) {
  const EnclaveFiles files = EnclaveFiles::in(folder);
  for (const auto& file : {files.identity_authority, files.certificate, files.key,
                           files.permissions_authority, files.governance, files.permissions})
    if (!std::ifstream(file))
      throw Failure(ErrorCode::NotFound,
                    file.string() +
                        ": cannot be read; an enclave of SROS 2 has it (KEYSTORE/enclaves/NAME, "
                        "made by: ros2 security create_enclave KEYSTORE /NAME)");
}

}  // namespace kinship::security

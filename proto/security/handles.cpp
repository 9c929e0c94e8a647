#include "proto/security/handles.hpp"

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include <array>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::security {

void DeleteKey::operator()(evp_pkey_st* key) const noexcept { EVP_PKEY_free(key); }

void DeleteCertificate::operator()(x509_st* certificate) const noexcept { X509_free(certificate); }

void throw_openssl(std::string_view what) {
  std::array<char, 256> reason{};
  ERR_error_string_n(ERR_peek_error(), reason.data(), reason.size());
  ERR_clear_error();
  throw Failure(ErrorCode::Internal, std::string(what) + ": " + reason.data());
}

}  // namespace kinship::security
